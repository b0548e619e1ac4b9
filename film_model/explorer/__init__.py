"""The explorer: one page that simulates impacts in a browser, on the same core compiled to WebAssembly."""
