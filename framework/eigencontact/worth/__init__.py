"""What a scene was understood to say, and what its numbers are worth: foreseen from the model, noticed in results."""
