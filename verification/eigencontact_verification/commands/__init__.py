"""Commands of verification; these modules import little, because the help of `eigencontact` loads them."""
