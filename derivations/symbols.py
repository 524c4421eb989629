r"""The symbols of the paper, with the assumptions under which every step is proved.

Sign convention: the foundation moves through the frame of the indenter with V > 0, so an element
enters at the leading edge x < 0 and leaves at the trailing edge; a reversed drive mirrors it.

Scaled symbols of steady sliding: ``l`` is l_r/a, ``q`` is x_TE/a, related by l = (1 - q**2)/(2 q).
"""

import sympy as sp


def _positive(names: str) -> tuple[sp.Symbol, ...]:
    return sp.symbols(names, positive=True)


# Scene: indenter, foundation, operation (Table 1) and gravity.
R, M, K, C, tau, N, V, g = _positive("R M K C tau N V g")
delta, W, F, mu = _positive("delta W F mu")
k, c = _positive("k c")
"""Stiffness and damping of one element per unit width; k = K/N, c = C/N (before Eq. 1)."""

# Lengths of the contact (Eqs. 26-29).
a, l_r = _positive("a l_r")
x_le = sp.Symbol("x_LE", negative=True)
x_te = sp.Symbol("x_TE", nonnegative=True)

# Coordinates.
t, t_0 = sp.symbols("t t_0", real=True)
x = sp.Symbol("x", real=True)
z = sp.Function("z", real=True)
"""Height of the surface of the indenter, at x."""

# Scaled steady sliding.
q, l = _positive("q l")
xi = sp.Symbol("xi", real=True)
Lambda = sp.Symbol("Lambda", positive=True)

# An element of the foundation at x_i(t), and the indenter above it (Eqs. 1-25).
x_i = sp.Function("x_i", real=True)(t)
u_i = sp.Function("u_i", real=True)(t)
delta_t = sp.Function("delta", positive=True)(t)
z_a = sp.Function("z_A", real=True)(t)
h = sp.Function("h", real=True)
f_n, f_c, f_z, f_x, theta = sp.symbols("f_Ni f_Ci f_zi f_xi theta_i", real=True)
F_z, F_x = sp.symbols("F_z F_x", real=True)

# The contact as a whole.
p = sp.Symbol("p", real=True)
V_star = sp.Symbol("V_star", positive=True)

# The theorems: scaled load, friction force and coefficient (F1), pressure (F7, F16), energy (F6).
w, phi, m, P_max, n, eta = _positive("w phi m P_max n eta")
P = sp.Symbol("P", real=True)
F_elastic, F_viscous = _positive("F_elastic F_viscous")
X, Y, T = _positive("X Y T")
"""For a dead weight (F2): the cubes of the scaled velocity and of the scaled friction coefficient, and
the ratio of the friction coefficient to its low-velocity asymptote."""
mu_peak, Lambda_peak, Lambda_fixed, Lambda_weight = _positive(
    "mu_peak Lambda_peak Lambda_fixed Lambda_weight"
)
mu_max, V_max = _positive("mu_max V_max")

# The balance of forces of a movable indenter, scaled by the static state.
s, lam, r = _positive("s lambda r")
kappa = sp.Symbol("kappa", nonnegative=True)
f, f_s, f_ss = _positive("f f_s f_ss")
G, G_s = sp.symbols("G G_s", real=True)

# Relative errors of the asymptotes, and the parts of which they are made.
e_l1, e_l2_fixed, e_l2_weight, e_load_low, e_load_high, e_friction_low, e_friction_high = (
    sp.symbols("e_L1 e_L2 e_L2_weight e_W_low e_W_high e_F_low e_F_high", real=True)
)
e_depth_low, e_depth_high, e_load_spring = sp.symbols("e_depth_low e_depth_high e_W", real=True)
E, S, b, gap = _positive("E S b gap")

# The true circle: (a/R)**2, first-order changes within the contact, coefficients of the corrections.
eps = sp.Symbol("epsilon", positive=True)
W_1, F_1 = sp.symbols("W_1 F_1", real=True)
c_w, c_f, c_mu, c_delta_load, c_mu_load = sp.symbols("c_W c_F c_mu c_delta_W c_mu_W", real=True)
tilt = sp.Symbol("slope", positive=True)
slope_square = sp.Symbol("slope_square", real=True)
circle_number, turning, turning_angle = _positive("v_c s_c angle")

# The transient, scaled by the static state: lengths by a_0, depths by delta_0, forces by W_0 and
# time by tau. A prime is the derivative with respect to the scaled time s.
a_0, delta_0, W_0, d = _positive("a_0 delta_0 W_0 d")
d_s, d_ss, f_normal, f_friction = sp.symbols("d_s d_ss f_normal f_friction", real=True)
time, earlier, start, sigma, zeta = sp.symbols("s s_1 s_0 sigma zeta", real=True)
depth, travel = (sp.Function(name, real=True)(time) for name in "dY")
"""The depth, and how far the foundation has moved: its element X is at xi = X + Y."""
material, left, right = sp.symbols("X ell r", real=True)
mix = sp.Symbol("theta", positive=True)
rho, beta, per_depth, per_rate, eps_critical = _positive("rho beta A B epsilon_c")
drive_excess = sp.Symbol("n", real=True)
drift, lift, change = sp.symbols("lambda_bar d_bar d_hat", real=True)
compression, indenter = (sp.Function(name, real=True) for name in "ug")
"""The surface of an element, and the indenter above it."""

# An indenter of any shape: the distance from its lowest line, and what each side of it contributes.
distance, W_ahead, W_behind, F_ahead = _positive("x_abs W_ahead W_behind F_ahead")
F_behind = sp.Symbol("F_behind", real=True)
q_root = sp.Symbol("q_root", positive=True)

# Power law h = |x|**n/(n L**(n - 1)) and wedge h = c |x|; y is |x|/a, Q is q**(n - 1), z is 1 - q**n.
exponent, excess, L, Q, y, z_peeled = _positive("n nu L Q y peeled")
"""The exponent n, and n - 1, which is positive for every shape that is no wedge."""
w_ahead, phi_ahead, lost_ahead = _positive("w_ahead phi_ahead e_ahead")
w_behind, phi_behind, lost_behind = sp.symbols("w_behind phi_behind e_behind", nonnegative=True)
w_n, phi_n, m_n, eta_n, P_n, l_cross, lam_cross = _positive(
    "w_n phi_n m_n eta_n P_n l_cross lambda_cross"
)
scaled_n, scaled_n_s = _positive("f_n f_n_s")
slip_n, T_n = sp.symbols("D_n T_n", real=True)
(e_n_l1, e_n_l2, e_n_load_low, e_n_load_high, e_n_friction_low, e_n_friction_high,
 e_n_depth_high) = sp.symbols(
    "e_L1_n e_L2_n e_W_low_n e_W_high_n e_F_low_n e_F_high_n e_depth_high_n", real=True
)  # fmt: skip
gap_edge, gap_slope, bend, phi_rise, phi_fall, psi, omega = _positive(
    "gap_q gap_Q bend phi_rise phi_fall psi omega"
)
w_rest, m_low, m_high = _positive("w_rest m_low m_high")
damped, whole, tip, sharp, blunt = _positive("damped whole tip sharp blunt")
"""Shorthands of sums in the errors of the asymptotes."""
p_le, p_te = sp.symbols("p_LE p_TE", nonnegative=True)
depth_rate_now, load_excess = sp.symbols("delta_t W_e", real=True)
logarithm, slope_rate = (sp.Function(name, real=True) for name in ("psi", "chi"))
"""ln h' of a shape, and its slope."""
travelled, ratio_near, ratio_now, ratio_gain = _positive("m rho_1 rho_2 beta_1")
s_peeling, s_peeled, held, inclination = _positive("s_1 s_2 held c_1")

# Any linear viscoelastic foundation: one arm that relaxes as exp(-X/l_i), over the length c of the contact.
arm_number, place, half_share, excess_share, from_trailing, contact_length, arm_length = _positive(
    "z_v x_v a_v eta_v w_v c_v l_v"
)
"""c/l_i; distance from the leading edge over c; a/c; a/c - 1/2; distance from the trailing edge over c."""
passed = sp.Symbol("s_v", real=True)
moment_ahead, moment_behind, moment_mean, moment_slant, moment_bulge, moment_twist = _positive(
    "P_v Q_v A_v B_v D_v E_v"
)
arm_pressure, arm_load, arm_work, arm_lost = _positive("p_v W_v F_v L_v")
spring_share, springpot = _positive("nu_v zeta_v")
ratio_first, ratio_second = _positive("t_v0 t_v1")
primitive_1, primitive_2, primitive_3 = (
    sp.Function(f"G_v{n}", positive=True)(contact_length) for n in (1, 2, 3)
)
relaxation = sp.Function("G_v", positive=True)(contact_length)
behind, edge_distance = _positive("X_v y_v")
"""Distance from the leading edge, and a distance back from there or behind the trailing edge."""
memory = sp.Function("G_v", positive=True)
repeated = tuple(sp.Function(f"G_v{n}", nonnegative=True) for n in (1, 2, 3, 4))
fading = sp.Function("H_v", nonnegative=True)
"""The relaxation function at a distance, its repeated integrals, and how fast it falls."""
arm_ratio, left_behind, parting, spring_1, spring_2 = _positive("beta_v u_v sigma_v K_v1 K_v2")
damper_1, damper_2, share_1, share_2, on_off = sp.symbols(
    "u_v1 u_v2 gamma_v1 gamma_v2 theta_v", nonnegative=True
)
spare_1, spare_2, spare_3 = sp.symbols("omega_v1 omega_v2 omega_v3", nonnegative=True)
delay, spring_number = _positive("epsilon_v kappa_v")
lack_mean, lack_ahead, lack_twist = sp.symbols("alpha_vA alpha_vP alpha_vE", nonnegative=True)
haste, steepness, load_number, friction_number = _positive("omega_v chi_v Lambda_v m_v")
slowing, other_fading, weight_at, part_at = (
    sp.Function(name, nonnegative=True) for name in ("C_v", "H_w", "k_v", "n_v")
)
"""How fast the fall slows; that of another series, any weight, and where between two bounds it is."""
relative = sp.Symbol("rho_v", positive=True)
pressed, shift, slope_free, felt = sp.symbols("g_v h_v s_vf J_v", real=True)
other_trailing = sp.Symbol("v_v", positive=True)

# A drive with a spring (F22): mass, damper and spring along x, where the indenter is, and what each
# becomes in scaled form; then the motions over their dampings, and what sets in.
M_x, k_x, eps_x, kappa_x, B_x = _positive("M_x k_x epsilon_x kappa_x B_x")
C_x, damper, damper_share, support_rate = sp.symbols("C_x c_x n_x S_s", nonnegative=True)
x_a = sp.Function("x_A", real=True)(t)
along, along_s, along_ss, along_0, swing, small = sp.symbols(
    "x_d x_ds x_dss x_d0 x_d1 theta_d", real=True
)
slides_more, sinks_faster, middle = sp.symbols("v_x v_z c_m", real=True)
length, power = _positive("l_c Pi_c")
lam_0 = sp.Symbol("lambda_0", real=True)
B_z, T_z, T_x, S_z, S_x, S_c, coupling, uncoupled = _positive("B_z T_z T_x S_z S_x S_c g_c h_c")
Omega, lag_plus, lag_minus, T_flutter = _positive("Omega p_p p_m T_f")
rise, own_rise, bias, onset_sum, hurwitz, Omega_plus, Omega_minus, onset_square = sp.symbols(
    "e_c e_0 m_c n_c H_c Omega_p Omega_m D_c", real=True
)
sinks = sp.Symbol("d_l", real=True)
"""How the depth changes with the drive number in steady sliding."""
spread = sp.Symbol("s_c", nonnegative=True)

# Small motions on an arm (F24): rates and times, four functions of each argument, and changes of both forces
# with depth and with displacement, of an arm and in all; temperature (F25).
rate_number, shifted_number, age, swing_rate, time_back = _positive("sigma_r z_r v_r s_r t_r")
delta_swing, x_swing, fading_depth, fading_drag = sp.symbols(
    "delta_r X_r alpha_r beta_r", real=True
)
kernels, kernels_still = _positive("phi_r1:5"), _positive("psi_r1:5")
normal_per_depth = sp.Symbol("f_zd", positive=True)
rubbing_per_depth, normal_per_drag, rubbing_per_drag = sp.symbols("f_xd f_zX f_xX", real=True)
total_normal_per_depth = sp.Symbol("F_zd", positive=True)
total_rubbing_per_depth, total_normal_per_drag, total_rubbing_per_drag = sp.symbols(
    "F_xd F_zX F_xX", real=True
)
shift_factor, stiffer, temperature, T_ref, wlf_1, wlf_2, activation, gas_constant = _positive(
    "a_T b_T T T_r C_1 C_2 E_A R_g"
)
memory_warm, memory_cold, strained = (sp.Function(name, real=True) for name in ("G_T", "G", "x_u"))

# A ball: place of a strip over its half width, arctan(1/l), and what its strips sum up to.
aside, ball_angle, ball_load, ball_friction, ball_coefficient, ball_edges = _positive(
    "y_b theta_b w_b phi_b m_b P_b"
)
ball_tail, ball_loss, ball_depth = _positive("T_b D_b I_b")
ball_rest, ball_kept, ball_lost, ball_mean = _positive("K_b M_b N_b g_b")
ball_scaled, ball_scaled_s, ball_scaled_ss = _positive("f_b f_b_s f_b_ss")
ball_l1, ball_l2, ball_load_low, ball_load_high = sp.symbols(
    "e_b_L1 e_b_L2 e_b_W_low e_b_W_high", real=True
)
ball_friction_low, ball_friction_high = sp.symbols("e_b_F_low e_b_F_high", real=True)
ball_share, ball_cubes = sp.symbols("eta_b Q_b", real=True)
ball_slip = sp.Symbol("E_b", real=True)
ball_cross, ball_lam_cross = _positive("l_b lambda_b")

alpha = 2 * sp.sqrt(2) / 3
"""The coefficient of Eqs. 40-46."""

# The transient on a Prony series (F23): what an arm remembers, its moments over the contact, free rates.
K_i, tau_i, E_i = _positive("K_i tau_i E_i")
t_1, t_in = sp.symbols("t_1 t_in", real=True)
alpha_i, beta_i, stress_i = (sp.Function(name, real=True) for name in ("alpha_i", "beta_i", "s_i"))
v_t, Y_t = (sp.Function(name, real=True)(t) for name in "vY")
le_t, te_t = sp.Function("x_LE", negative=True), sp.Function("x_TE", real=True)
S_i, T_i = (sp.Function(name, real=True)(t) for name in ("S_i", "T_i"))
I_n = sp.symbols("I_0:3", real=True)
linear, constant = _positive("b_h1:3"), sp.symbols("c_h1:3", real=True)
"""Coefficients of two quadratic factors (hurwitz)."""
glassy, *rates = _positive("K_g r_1 r_2")
fading_rate = sp.Symbol("rho_r", real=True)

TEX = {
    sp.Symbol("x_-", real=True): "x_{-}",
    sp.Symbol("x_TE", real=True): r"x_{\mathrm{TE}}",
    x_le: r"x_{\mathrm{LE}}",
    x_te: r"x_{\mathrm{TE}}",
    l_r: r"l_{\mathrm{r}}",
    xi: r"\xi",
    f_n: r"f_{\mathrm{N}i}",
    f_c: r"f_{\mathrm{C}i}",
    f_z: r"f_{zi}",
    f_x: r"f_{xi}",
    V_star: r"V^{*}",
    phi: r"\varphi",
    P: r"\hat p",
    P_max: r"\hat p_{\max}",
    F_elastic: r"F_{\mathrm{e}}",
    F_viscous: r"F_{\mathrm{v}}",
    mu_peak: r"\hat\mu_{\max}",
    mu_max: r"\mu_{\max}",
    V_max: r"V_{\max}",
    Lambda_peak: r"\Lambda_{\max}",
    Lambda_fixed: r"\Lambda^{*}_{\mathrm{FI}}",
    Lambda_weight: r"\Lambda^{*}_{\mathrm{MI}}",
    eps: r"\varepsilon",
    f_s: r"f'",
    f_ss: r"f''",
    G_s: r"G'",
    e_l1: r"e_{\mathrm{L1}}",
    e_l2_fixed: r"e_{\mathrm{L2\text{-}FI}}",
    e_l2_weight: r"e_{\mathrm{L2\text{-}MI}}",
    e_load_low: r"e_{W\!,\,V\to0}",
    e_load_high: r"e_{W\!,\,V\to\infty}",
    e_friction_low: r"e_{F\!,\,V\to0}",
    e_friction_high: r"e_{F\!,\,V\to\infty}",
    e_depth_low: r"e_{\delta,\,V\to0}",
    e_depth_high: r"e_{\delta,\,V\to\infty}",
    e_load_spring: r"e_{W}",
    gap: r"\bar q",
    d_s: "d'",
    d_ss: "d''",
    drift: r"\bar\lambda",
    lift: r"\bar d",
    change: r"\hat d",
    eps_critical: r"\varepsilon_{\mathrm{c}}",
    distance: r"\bar x",
    q_root: r"\hat q",
    W_ahead: r"W_{\mathrm{a}}",
    W_behind: r"W_{\mathrm{b}}",
    F_ahead: r"F_{\mathrm{a}}",
    F_behind: r"F_{\mathrm{b}}",
    f_normal: "f_z",
    f_friction: "f_x",
    c_delta_load: r"c_{\delta,W}",
    c_mu_load: r"c_{\mu,W}",
    excess: r"\nu",
    l_cross: "l^{*}",
    lam_cross: r"\lambda^{*}",
    z_peeled: "z",
    phi_n: r"\varphi_n",
    P_n: r"\hat p_{\max,n}",
    scaled_n_s: "f_n'",
    gap_edge: r"\bar q",
    gap_slope: r"\bar Q",
    w_rest: r"w_{n,0}",
    damped: r"D_{\mathrm{d}}",
    whole: r"D_{\mathrm{w}}",
    tip: r"D_{\mathrm{t}}",
    sharp: r"D_{\mathrm{s}}",
    blunt: r"D_{\mathrm{b}}",
    m_low: r"m_{n,0}'",
    m_high: r"m_{n,\infty}",
    bend: "b_n",
    phi_rise: r"\phi_{2,+}",
    phi_fall: r"\phi_{2,-}",
    w_ahead: r"w_{\mathrm{a}}",
    w_behind: r"w_{\mathrm{b}}",
    phi_ahead: r"\varphi_{\mathrm{a}}",
    phi_behind: r"\varphi_{\mathrm{b}}",
    lost_ahead: r"\eta_{\mathrm{a}}",
    lost_behind: r"\eta_{\mathrm{b}}",
    e_n_l1: r"e_{\mathrm{L1},n}",
    e_n_l2: r"e_{\mathrm{L2},n}",
    e_n_load_low: r"e_{W\!,\,V\to0,n}",
    e_n_load_high: r"e_{W\!,\,V\to\infty,n}",
    e_n_friction_low: r"e_{F\!,\,V\to0,n}",
    e_n_friction_high: r"e_{F\!,\,V\to\infty,n}",
    e_n_depth_high: r"e_{\delta,\,V\to\infty,n}",
    p_le: r"p_{\mathrm{LE}}",
    p_te: r"p_{\mathrm{TE}}",
    depth_rate_now: r"\dot\delta",
    load_excess: r"W_{\mathrm{e}}",
    inclination: "c",
    held: r"\bar w",
    ratio_gain: r"\beta",
    arm_number: r"\breve z",
    place: r"\breve x",
    half_share: r"\breve a",
    excess_share: r"\breve \eta",
    from_trailing: r"\breve w",
    contact_length: r"\breve c",
    arm_length: "l_i",
    passed: r"\breve s",
    moment_ahead: r"\breve P",
    moment_behind: r"\breve Q",
    moment_mean: r"\breve A",
    moment_slant: r"\breve B",
    moment_bulge: r"\breve D",
    moment_twist: r"\breve E",
    arm_pressure: r"\breve p",
    arm_load: r"\breve W",
    arm_work: r"\breve F",
    arm_lost: r"\breve L",
    spring_share: r"\breve \nu",
    springpot: r"\breve \zeta",
    ratio_first: r"\breve t_0",
    ratio_second: r"\breve t_1",
    behind: r"\breve X",
    edge_distance: r"\breve y",
    arm_ratio: r"\breve \beta",
    left_behind: r"\breve u",
    parting: r"\breve \sigma",
    spring_1: "K_1",
    spring_2: "K_2",
    damper_1: r"\breve u_1",
    damper_2: r"\breve u_2",
    share_1: r"\breve \gamma_1",
    share_2: r"\breve \gamma_2",
    on_off: r"\breve \theta",
    spare_1: r"\breve \omega_1",
    spare_2: r"\breve \omega_2",
    spare_3: r"\breve \omega_3",
    delay: r"\breve \varepsilon",
    spring_number: r"\breve \kappa",
    lack_mean: r"\breve \alpha_A",
    lack_ahead: r"\breve \alpha_P",
    lack_twist: r"\breve \alpha_E",
    pressed: r"\breve g",
    felt: r"\breve J",
    relative: r"\breve \rho",
    shift: r"\breve h",
    slope_free: r"\breve \chi_0",
    other_trailing: r"\breve v",
    haste: r"\breve \omega",
    load_number: r"\breve \Lambda",
    friction_number: r"\breve m",
    steepness: r"\breve \chi",
    rate_number: r"\tilde \sigma",
    t_in: r"t_{\mathrm{in}}",
    fading_rate: r"\tilde \varrho",
    **{symbol: rf"\check c_{n}" for n, symbol in enumerate(constant, 1)},
    **{symbol: rf"\check b_{n}" for n, symbol in enumerate(linear, 1)},
    glassy: r"K_{\mathrm{g}}",
    shifted_number: r"\tilde z",
    age: r"\tilde v",
    swing_rate: r"\tilde s",
    time_back: r"\tilde t",
    delta_swing: r"\tilde \delta",
    x_swing: r"\tilde X",
    fading_depth: r"\tilde \alpha",
    fading_drag: r"\tilde \beta",
    **{symbol: rf"\tilde \phi_{n}" for n, symbol in enumerate(kernels, 1)},
    **{symbol: rf"\tilde \psi_{n}" for n, symbol in enumerate(kernels_still, 1)},
    normal_per_depth: r"f_{z\delta}",
    rubbing_per_depth: r"f_{x\delta}",
    normal_per_drag: "f_{zX}",
    rubbing_per_drag: "f_{xX}",
    total_normal_per_depth: r"F_{z\delta}",
    total_rubbing_per_depth: r"F_{x\delta}",
    total_normal_per_drag: "F_{zX}",
    total_rubbing_per_drag: "F_{xX}",
    T_ref: r"T_{\mathrm{r}}",
    activation: r"E_{\mathrm{A}}",
    gas_constant: r"R_{\mathrm{g}}",
    x_a: r"x_{\mathrm{A}}",
    eps_x: r"\varepsilon_x",
    kappa_x: r"\kappa_x",
    along: r"\check x",
    along_s: r"\check x'",
    along_ss: r"\check x''",
    along_0: r"\check x_0",
    swing: r"\check x_1",
    small: r"\check \theta",
    slides_more: r"\check v_x",
    sinks_faster: r"\check v_z",
    length: r"\check l",
    middle: r"\check \xi",
    power: r"\check \Pi",
    T_z: r"\vartheta_z",
    T_x: r"\vartheta_x",
    S_z: r"\varrho_z",
    S_x: r"\varrho_x",
    S_c: r"\varrho_{\mathrm{c}}",
    support_rate: r"\varrho_{\mathrm{s}}",
    coupling: r"\check g",
    uncoupled: r"\check h",
    rise: r"\check e",
    own_rise: r"\check e_0",
    Omega: r"\Omega",
    Omega_plus: r"\Omega_{+}",
    Omega_minus: r"\Omega_{-}",
    lag_plus: r"\check p_{+}",
    lag_minus: r"\check p_{-}",
    T_flutter: r"\vartheta_{\mathrm{f}}",
    hurwitz: r"\check H",
    sinks: r"d_\lambda",
    bias: r"\check m",
    onset_sum: r"\check n",
    spread: r"\check w",
    onset_square: r"\check D",
    tilt: r"\hat h'",
    slope_square: r"\hat S",
    circle_number: r"\hat l",
    turning: r"\hat s",
    turning_angle: r"\hat \theta",
    aside: r"\tilde \zeta",
    ball_depth: r"\tilde I",
    ball_rest: r"\tilde K",
    ball_mean: r"\tilde g",
    ball_kept: r"\tilde M",
    ball_lost: r"\tilde N",
    ball_edges: r"\tilde P",
    ball_cubes: r"\tilde Q",
    ball_angle: r"\tilde \theta",
    ball_load: r"\tilde w",
    ball_friction: r"\tilde \varphi",
    ball_coefficient: r"\tilde m",
    ball_share: r"\tilde \eta",
    ball_tail: r"\tilde T",
    ball_loss: r"\tilde D",
    ball_scaled: r"\tilde f",
    ball_scaled_s: r"\tilde f'",
    ball_scaled_ss: r"\tilde f''",
    ball_l1: r"\tilde e_{\mathrm{L1}}",
    ball_l2: r"\tilde e_{\mathrm{L2}}",
    ball_load_low: r"\tilde e_{W\!,\,V\to0}",
    ball_load_high: r"\tilde e_{W\!,\,V\to\infty}",
    ball_friction_low: r"\tilde e_{F\!,\,V\to0}",
    ball_friction_high: r"\tilde e_{F\!,\,V\to\infty}",
    ball_slip: r"\tilde E",
    ball_cross: r"\tilde l^{*}",
    ball_lam_cross: r"\tilde \lambda^{*}",
}
"""How `sympy.latex` prints these symbols where its own choice differs from the paper's."""
