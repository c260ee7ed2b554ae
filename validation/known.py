"""What several cases of validation/ compare the program with: digits of the paper, of other codes, and
limits. mu_s = tau = 1 and b(v) = -v unless something else is stated; digits as they were printed."""

# Monte Carlo values of the paper's figure of convergence in p, mu_d = 1/4, by delta.
SIMULATED = {"P_stick": {1 / 2: "0.2898", 1 / 4: "0.1972", 1 / 8: "0.1565", 1 / 16: "0.1380",
                         1 / 32: "0.1302"},
             "E_V2": {1 / 2: "0.288", 1 / 4: "0.301", 1 / 8: "0.306", 1 / 16: "0.309",
                      1 / 32: "0.3088"},
             "P_X_le_mu_s": {1 / 2: "0.789", 1 / 4: "0.739", 1 / 8: "0.711", 1 / 16: "0.698"}}
# P(|X| <= mu_s) from the left kernel of the noise's generator, in the figure itself; any mu_d.
P_X = {1 / 2: "0.789886474609376", 1 / 4: "0.739564523423343", 1 / 8: "0.712010713468334",
       1 / 16: "0.697578849841333", 1 / 32: "0.690192311713429"}

# f_stick(0+) by mu_d at delta = 1/8, 1/16, 1/32: another code, and Kolmogorov/Monte Carlo of Table 1.
F_STICK_0 = {0.25: ("5.32153", "10.83774", "21.83499"), 0.5: ("2.19755", "4.25902", "8.36837"),
             0.75: ("0.68153", "1.24353", "2.36272"), 1: ("0.132599", "0.185010", "0.260757")}
TABLE_1 = {0.25: ("5.32/6.73", "10.83/10.51", "21.81/20.94"),
           0.5: ("2.20/2.78", "4.26/4.10", "8.36/7.98"),
           0.75: ("0.68/0.89", "1.24/1.17", "2.36/2.27"),
           1: ("0.17/0.18", "0.41/0.76", "1.12/9.20")}

# S_v at omega = 0, 0.1, 1, 10 for mu_d = 1/4 by delta, another code.
S_V = {1 / 2: ("1.05184088", "1.03401702", "0.310095661", "1.85013e-4"),
       1 / 4: ("1.08314710", "1.06555462", "0.330747341", "1.91001e-4")}
# F_slide(1), F_stick(1) for delta = 1 by mu_d: by one Chebyshev polynomial in v on each level, dense.
F_1 = {1: ("0.301282642717", "0.179691207960"), 0.25: ("0.124123808609", "0.221868272518")}
# t_corr for tau -> 0 and mu_d = 1 by the drag law.
T_CORR = {"none": 1.35446038, "linear": 0.247854704305}
