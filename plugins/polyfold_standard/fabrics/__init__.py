"""The bundled fabrics, one a module, each constant with its source."""
