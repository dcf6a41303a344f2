"""FFT convolution of fields on surfaces and in volumes with kernels, without physics.

>>> import numpy as np
>>> from eigencontact.convolution import Convolver, Layout
>>> layout = Layout(source=(4, 6), target=(4, 6))
>>> y, x = layout.y.lattice[:, None], layout.x.lattice[None, :]
>>> kernel = layout.spectrum(1.0 / (1.0 + x**2 + y**2), parity=(1, 1))
>>> field = np.zeros((4, 6)); field[1, 2] = 1.0
>>> out = Convolver(layout).apply(field, kernel)
>>> out.shape, round(float(out[1, 3]), 12)
((4, 6), 0.5)

In a volume, kernels may depend on the difference or on the sum of the indices along z:

>>> from eigencontact.convolution import VolumeConvolver, VolumeKernels, VolumeLayout, WeightedSums
>>> box = VolumeLayout((3, 4, 5), (3, 4, 5))
>>> kernels = VolumeKernels(box, parities=[(1, 1, 1)], correlations=[True])
>>> kernels.fill(0, 1.0 / (1.0 + box.x.lattice[:, None, None] ** 2 + box.y.lattice[:, None] ** 2 + box.lattice_sum))
>>> sums = WeightedSums(kernels, {(0, 0): {(0, 0): 2.0}}, sources=[(1, 1)], outputs=[(1, 1)])
>>> field = np.zeros((1, 3, 4, 5)); field[0, 1, 2, 3] = 1.0
>>> out = VolumeConvolver(sums, depths=[0.0, 1.0, 2.0]).apply(field)
>>> out.shape, round(float(out[0, 2, 2, 3]), 12)
((1, 3, 4, 5), 0.5)
"""

from importlib import import_module
from typing import TYPE_CHECKING

from eigencontact.convolution.convolver import Convolver
from eigencontact.convolution.layout import Layout
from eigencontact.convolution.spectrum import Spectrum

if TYPE_CHECKING:
    from eigencontact.convolution.volume import VolumeConvolver
    from eigencontact.convolution.volume_layout import VolumeKernels, VolumeLayout
    from eigencontact.convolution.weighted_sums import WeightedSums

__all__ = ["Convolver", "Layout", "Spectrum", "VolumeConvolver", "VolumeKernels", "VolumeLayout", "WeightedSums"]

#: Imported when first asked for: a contact without eigenstrain convolves on surfaces alone.
_VOLUME = {
    "VolumeConvolver": "volume",
    "VolumeKernels": "volume_layout",
    "VolumeLayout": "volume_layout",
    "WeightedSums": "weighted_sums",
}


def __getattr__(name: str) -> object:
    if name not in _VOLUME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_VOLUME[name]}"), name)
