"""Pictures of a case; nothing here decides a verdict, so none of it is hashed with stored solutions."""
