"""What arrays hold, for annotations; their shapes stand where they are documented."""

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
BoolArray = NDArray[np.bool_]
