"""Forces that are Markov chains: made by name or of a record, added, scaled and shifted, and given to `run(noise=...)`.

>>> from stickslip import noise
>>> chain = noise.periodic(1.2, 4) + noise.ou(0.7, tau=1, delta=0.5)
>>> stickslip.run(noise=chain, mu_d=0.6)["P_stick"]
"""

from .chains import Chain, Meant
from .chains_by_name import narrow_band, ou, periodic, telegraph
from .chains_of_records import Fit, record
from .filtered_noise_of_records import Filtered, filtered_of
from .narrow_bands_of_records import Band, narrow_band_of

__all__ = ["Band", "Chain", "Filtered", "Fit", "Meant", "filtered_of", "narrow_band", "narrow_band_of", "ou", "periodic",
           "record", "telegraph"]
