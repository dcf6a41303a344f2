"""FFT convolution of surface fields with influence coefficients. It knows no physics and works by itself.

>>> import numpy as np
>>> from eigencontact.convolution import Convolver, Layout
>>> layout = Layout(source=(4, 6), target=(4, 6))
>>> y, x = layout.lattice_y[:, None], layout.lattice_x[None, :]
>>> kernel = layout.spectrum(1.0 / (1.0 + x**2 + y**2), parity=(1, 1))
>>> field = np.zeros((4, 6)); field[1, 2] = 1.0
>>> out = Convolver(layout).apply(field, kernel)
>>> out.shape, round(float(out[1, 3]), 12)
((4, 6), 0.5)
"""

from eigencontact.convolution.convolver import Convolver
from eigencontact.convolution.layout import Layout
from eigencontact.convolution.spectrum import Spectrum

__all__ = ["Convolver", "Layout", "Spectrum"]
