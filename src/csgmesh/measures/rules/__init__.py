"""The rules of the certificate, a file a group. Each takes the case and returns checks."""
