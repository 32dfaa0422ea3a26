"""Units of measure: texts of files and FMUs, the quantities they name, and the maps between them."""
