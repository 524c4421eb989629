"""What stands around the derivations: title, introduction, vocabulary, nomenclature, source."""

TITLE = "Sliding friction on a Kelvin–Voigt foundation: derivations"

AUTHORS = "Nakano and Kono (2020)"

INTRODUCTION = (
    "A rigid cylinder presses into a row of independent Kelvin–Voigt elements and slides over it. "
    f"{AUTHORS} state the model, its transient and its steady state in numbered equations; here "
    "each of them is defined or derived, together with further results on the same model, which are "
    "named theorems (F1 and so on). Equation numbers without a letter are those of the paper.",
    "Every line is an equality or an inequality that computer algebra checked when this document "
    "was made; a line that does not hold stops the making. With each line stands its reason and "
    "what the check was worth; the sentence before it tells what is given: definitions, and what "
    "was established elsewhere, by its number. A result is worth as much as its weakest line.",
    "A check establishes the formula of its line, on the domain that is given with it, from the "
    "definitions and results that are named; what is printed was read back and compared with what was "
    "checked. The words beside a line say what the formula means for the contact: that a law of the "
    "model is the right one, and that lines together prove what a title says, rests on them.",
)

VOCABULARY = {
    "definition": "a name or a law of the model is introduced; there is nothing to prove",
    "proved": "an identity, a sign or a number of roots, proved by exact algebra",
    "proved-leading-order": "an asymptote, proved with the coefficient and the order of its "
    "remainder",
    "sampled": "compared at many random admissible points with 50 digits, not proved",
}
"""The meaning of each `record.STATUSES`."""

NOMENCLATURE_HEADS = ("Symbol", "Meaning", "Unit")
NOMENCLATURE = (
    ("$R$", "radius of the indenter", "m"),
    ("$M$", "mass of the indenter per unit width", "kg/m"),
    ("$K$", "stiffness of the foundation per unit area", "N/m³"),
    ("$C$", "damping of the foundation per unit area", "N s/m³"),
    (r"$\tau$", "retardation time, $C/K$", "s"),
    ("$N$", "number of elements per unit length", "1/m"),
    ("$k$", "stiffness of one element per unit width, $K/N$", "N/m²"),
    ("$c$", "damping of one element per unit width, $C/N$", "N s/m²"),
    ("$V$", "drive velocity", "m/s"),
    ("$g$", "gravity", "m/s²"),
    ("$t$", "time", "s"),
    ("$x$, $z$", "coordinates along and across the foundation", "m"),
    ("$h$", "shape function of the indenter", "m"),
    ("$u$", "compression of an element", "m"),
    (r"$\delta$", "indentation depth", "m"),
    ("$a$", r"half length of the stationary contact, $\sqrt{2 R \delta}$", "m"),
    (r"$l_{\mathrm{r}}$", r"retardation length, $V \tau$", "m"),
    (r"$x_{\mathrm{LE}}$, $x_{\mathrm{TE}}$", "leading and trailing edge of the contact", "m"),
    ("$p$", "contact pressure", "Pa"),
    ("$F_z$, $F_x$", "vertical and horizontal force per unit width", "N/m"),
    ("$W$, $F$", "load and friction force in steady sliding, per unit width", "N/m"),
    (r"$\mu$", "friction coefficient, $F/W$", "1"),
    ("$V^{*}$", "critical velocity, where the two asymptotes cross", "m/s"),
    ("$l$", r"$l_{\mathrm{r}}/a$", "1"),
    ("$q$", r"$x_{\mathrm{TE}}/a$, from 1 at rest down to 0 at high velocity", "1"),
    (r"$\xi$", "$x/a$", "1"),
    (r"$\hat p$", r"scaled pressure, $p/(K \delta)$", "1"),
    ("$w$", r"scaled load, $W/(K \delta a)$", "1"),
    (r"$\varphi$", r"scaled friction force, $F R/(K \delta a^{2})$", "1"),
    ("$m$", r"scaled friction coefficient, $\mu R/a$", "1"),
    (r"$\Lambda$", r"scaled velocity of the dead-weight model, $V \tau (K/(R W))^{1/3}$", "1"),
    (r"$\alpha$", r"$2 \sqrt{2}/3$", "1"),
    (r"$\delta_0$, $a_0$, $W_0$", "static depth, half length and load", "m, m, N/m"),
    ("$s$", r"scaled time, $t/\tau$", "1"),
    ("$d$", r"scaled depth, $\delta/\delta_0$", "1"),
    (r"$\lambda$", r"drive number, $V \tau/a_0$", "1"),
    (r"$\epsilon$", r"inertia number, $M \delta_0/(W_0 \tau^{2})$", "1"),
    (r"$\kappa$", r"support number, $k_s \delta_0/W_0$", "1"),
    ("$f_z$, $f_x$", r"scaled forces, $F_z/W_0$ and $F_x a_0/(W_0 \delta_0)$", "1"),
)

SOURCE = (
    "K. Nakano and M. Kono, Transient and steady sliding friction of elastomers: impact of "
    "vertical lift, Frontiers in Mechanical Engineering 6, 38 (2020)."
)
DOI = "10.3389/fmech.2020.00038"
