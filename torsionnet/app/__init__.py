"""Commands, page in the browser, server of editors, and the services on texts of model files that they share."""
