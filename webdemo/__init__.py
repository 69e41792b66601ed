"""The application: inference, the page, the server and the shell commands."""
