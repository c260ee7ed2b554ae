"""Random forces: Gaussian noise, and Markov chains by name or of a record; added, scaled and given to `run(noise=...)`.

>>> from stickslip import noise
>>> stickslip.run(noise=noise.filtered(2, 15.6, 0.6) + noise.ou(0.7, tau=1), mu_d=0.5)["P_stick"]
>>> chain = noise.periodic(1.2, 4) + noise.ou(0.7, tau=1, delta=0.5)
>>> stickslip.run(noise=chain, mu_d=0.6)["P_stick"]
"""

from .chains import Chain, Meant
from .chains_by_name import periodic, telegraph
from .chains_of_records import Fit, record
from .gaussian_noise import Gaussian, filtered, gaussian, narrow_band, ou
from .gaussian_noise_of_records import Fitted, filtered_of, gaussian_of, narrow_band_of

__all__ = ["Chain", "Fit", "Fitted", "Gaussian", "Meant", "filtered", "filtered_of", "gaussian", "gaussian_of",
           "narrow_band", "narrow_band_of", "ou", "periodic", "record", "telegraph"]
