"""The npm package, and the page that lifts in the browser."""
