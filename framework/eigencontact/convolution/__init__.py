"""FFT convolution of surface tractions with influence coefficients. It knows no physics."""
