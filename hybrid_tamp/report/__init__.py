"""VERB 5: whatever the other verbs made goes in, text, pictures and documents for people and programs come out."""
