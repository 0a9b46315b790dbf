// Placeholder for folders without sources yet.
