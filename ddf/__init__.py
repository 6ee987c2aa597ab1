"""ddf: double diaphragm forming of woven fabric."""

from ddf.kernel_cache import use_cache

__version__ = "0.1.0"

use_cache()
