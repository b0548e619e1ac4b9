"""The rows of the catalogue of materials, each value with its source."""

from __future__ import annotations

from typing import NamedTuple


class Row(NamedTuple):
    """One material: modulus in GPa, density in kg/m³, strengths in MPa, surface energy in J/m².

    words: other names. more: sources of the values after the yield strength.
    """

    name: str
    modulus: float
    ratio: float
    density: float
    strength: float | None
    source: str
    rate: float | None = None
    loss: float | None = None
    tensile: float | None = None
    surface: float | None = None
    more: str = ""
    words: tuple[str, ...] = ()


_PAPER = "Big-Alabo, Cartmell & Harrison 2017, Table 2"
_METAL = "nominal handbook value for the "
_BRITTLE = "nominal handbook value; breaks before it yields"
_POLYMER = "nominal handbook value at room temperature and slow loading"
_JOHNSON_COOK = "C of {}: Johnson & Cook 1983"
_DAMPING = "loss factor: within the range of Beranek & Vér 1992, Noise and Vibration Control Engineering"
_GLASS = "EN 572-1 (elastic constants, density), {} (characteristic strength in bending)"
_GENT = "modulus from the hardness: Gent 1958, Rubber Chem. Technol. 31:896, density typical of the kind, ±5 %"
_WOOD = "Hearmon 1948, in Kollmann & Côté 1968 (radial modulus), as isotropic, along the grain 6 to 20 times stiffer"
_PLY = "Daniel & Ishai 2006, table A.4, modulus across the plies, as isotropic: for the contact, not for bending"
_STACK = ", averaged over 0, 45, 90 and -45 degrees"

ROWS: tuple[Row, ...] = (
    Row(
        "steel",
        210,
        0.30,
        7850,
        235,
        "EN 1993-1-1, S235, the weakest structural steel, hardened steels yield at up to 2000 MPa",
        0.022,
        3e-4,
        more=f"{_JOHNSON_COOK.format('1006 steel')}; {_DAMPING}",
        words=("generic steel", "structural steel", "S235"),
    ),
    Row(
        "mild steel",
        210,
        0.30,
        7850,
        250,
        _METAL + "hot-rolled state",
        0.022,
        3e-4,
        more=f"{_JOHNSON_COOK.format('1006 steel')}; {_DAMPING}",
        words=("carbon steel", "low-carbon steel"),
    ),
    Row(
        "bearing steel",
        210,
        0.30,
        7810,
        2030,
        _METAL + "hardened state of AISI 52100",
        loss=3e-4,
        more=_DAMPING,
        words=("AISI 52100", "52100", "100Cr6"),
    ),
    Row(
        "stainless steel 304",
        193,
        0.29,
        8000,
        215,
        _METAL + "annealed state",
        loss=3e-4,
        more=_DAMPING,
        words=("stainless steel", "AISI 304", "304"),
    ),
    Row(
        "aluminium",
        70,
        0.30,
        2700,
        140,
        "EN 1999-1-1, extruded EN AW-6060 T6, a soft structural alloy, others yield at up to 500 MPa",
        loss=1e-4,
        more=_DAMPING,
        words=("generic aluminium", "EN AW-6060"),
    ),
    Row(
        "aluminium 6061-T6",
        68.9,
        0.33,
        2700,
        276,
        _METAL + "T6 state",
        0.002,
        1e-4,
        more=f"C: Lesuer, Kay & LeBlanc 2001, UCRL-JC-134118; {_DAMPING}",
        words=("6061-T6", "6061"),
    ),
    Row(
        "aluminium 2024-T3",
        73.1,
        0.33,
        2780,
        345,
        _METAL + "T3 state",
        0.015,
        1e-4,
        more=f"{_JOHNSON_COOK.format('2024-T351')}; {_DAMPING}",
        words=("2024-T3", "2024"),
    ),
    Row(
        "titanium Ti-6Al-4V",
        113.8,
        0.342,
        4430,
        880,
        _METAL + "annealed state",
        0.014,
        more="C: Lesuer 2000, DOT/FAA/AR-00/25",
        words=("titanium", "Ti-6Al-4V", "Ti64"),
    ),
    Row(
        "copper",
        117,
        0.34,
        8940,
        70,
        _METAL + "annealed state",
        0.025,
        2e-3,
        more=f"{_JOHNSON_COOK.format('OFHC copper')}; {_DAMPING}",
        words=("Cu",),
    ),
    Row(
        "brass",
        105,
        0.34,
        8500,
        200,
        _METAL + "half-hard state of cartridge brass",
        0.009,
        more=_JOHNSON_COOK.format("cartridge brass"),
    ),
    Row(
        "cast iron",
        110,
        0.26,
        7200,
        None,
        _BRITTLE + " (grey iron)",
        tensile=250,
        more="tensile strength: EN 1561, EN-GJL-250",
        words=("grey iron", "gray iron"),
    ),
    Row("tungsten carbide", 600, 0.28, 14500, None, _PAPER, words=("WC", "cemented carbide")),
    Row(
        "alumina",
        370,
        0.22,
        3900,
        None,
        _BRITTLE + " (99 % pure)",
        tensile=262,
        more="tensile strength: data sheet of CoorsTek AD-995",
        words=("Al2O3", "aluminium oxide"),
    ),
    Row(
        "zirconia",
        210,
        0.30,
        6050,
        None,
        _BRITTLE + " (yttria-stabilised)",
        tensile=800,
        more="strength in four-point bending: least of ISO 13356",
        words=("ZrO2", "Y-TZP"),
    ),
    Row(
        "silicon nitride",
        310,
        0.27,
        3200,
        None,
        _BRITTLE + " (bearing grade)",
        words=("Si3N4",),
    ),
    Row(
        "soda-lime glass",
        70,
        0.22,
        2500,
        None,
        _BRITTLE,
        loss=1e-3,
        tensile=45,
        more=f"strength of annealed glass in bending: characteristic value of EN 572-1; {_DAMPING}",
        words=("glass",),
    ),
    Row(
        "float glass, annealed",
        70,
        0.20,
        2500,
        None,
        _GLASS.format("EN 572-1"),
        loss=1e-3,
        tensile=45,
        more=_DAMPING,
        words=("float glass", "annealed glass", "window glass"),
    ),
    Row(
        "float glass, toughened",
        70,
        0.20,
        2500,
        None,
        _GLASS.format("EN 12150-1"),
        loss=1e-3,
        tensile=120,
        more=_DAMPING,
        words=("toughened glass", "tempered glass"),
    ),
    Row(
        "ice",
        9.33,
        0.325,
        917,
        None,
        "Gammon et al. 1983, J. Phys. Chem. 87:4025, -16 °C, breaks before it yields in fast loading",
        tensile=1.43,
        surface=0.109,
        more="tensile strength: mean of Petrovic 2003, J. Mater. Sci. 38:1; surface energy: Ketcham & Hobbs 1969",
    ),
    Row(
        "concrete C30/37",
        33,
        0.20,
        2400,
        None,
        "EN 1992-1-1 (mean values), crushes before it yields",
        loss=0.01,
        tensile=2.9,
        more=f"tensile strength: f_ctm of EN 1992-1-1; {_DAMPING}",
        words=("concrete", "C30/37"),
    ),
    Row(
        "granite",
        70.5,
        0.18,
        2670,
        None,
        "Goodman 1989, Introduction to Rock Mechanics: Pikes Peak granite, others from 20 to 70 GPa",
        tensile=11.9,
        more="tensile strength: the same",
    ),
    Row(
        "PMMA",
        3.0,
        0.37,
        1180,
        70,
        _POLYMER,
        loss=0.03,
        surface=0.041,
        more=f"{_DAMPING}; surface energy: Wu 1982, Polymer Interface and Adhesion",
        words=("acrylic", "acrylic glass", "plexiglas", "plexiglass", "perspex", "polymethyl methacrylate"),
    ),
    Row("polycarbonate", 2.4, 0.37, 1200, 62, _POLYMER, words=("PC", "makrolon", "lexan")),
    Row(
        "nylon 6/6",
        2.9,
        0.40,
        1140,
        80,
        _POLYMER + ", dry",
        surface=0.0465,
        more="surface energy: Wu 1982, Polymer Interface and Adhesion",
        words=("nylon", "PA", "PA66", "PA 66", "PA 6/6", "polyamide", "polyamide 6/6"),
    ),
    *(
        Row(
            f"natural rubber {hardness} Shore A",
            modulus,
            0.499,
            1100,
            None,
            _GENT,
            surface=0.0355,
            more="surface energy: Johnson, Kendall & Roberts 1971",
            words=(f"rubber {hardness} Shore A", f"NR {hardness} Shore A"),
        )
        for hardness, modulus in ((40, 1.69e-3), (50, 2.46e-3), (60, 3.61e-3), (70, 5.52e-3))
    ),
    *(
        Row(f"polyurethane {hardness} Shore A", modulus, 0.499, 1150, None, _GENT, words=(f"PU {hardness} Shore A",))
        for hardness, modulus in ((80, 9.35e-3), (90, 20.8e-3))
    ),
    Row("beech, across the grain", 2.24, 0.30, 750, None, _WOOD, loss=0.01, more=_DAMPING, words=("beech",)),
    Row("spruce, across the grain", 0.71, 0.30, 390, None, _WOOD, loss=0.01, more=_DAMPING, words=("spruce",)),
    Row("carbon/epoxy UD", 10.3, 0.30, 1600, None, f"AS4/3501-6: {_PLY}", words=("CFRP UD", "carbon/epoxy")),
    Row(
        "carbon/epoxy quasi-isotropic",
        13.6,
        0.30,
        1600,
        None,
        f"AS4/3501-6: {_PLY}{_STACK}",
        words=("CFRP", "CFRP quasi-isotropic"),
    ),
    Row("glass/epoxy UD", 10.4, 0.30, 1970, None, f"E-glass/epoxy: {_PLY}", words=("GFRP UD", "glass/epoxy")),
    Row(
        "glass/epoxy quasi-isotropic",
        12.0,
        0.30,
        1970,
        None,
        f"E-glass/epoxy: {_PLY}{_STACK}",
        words=("GFRP", "GFRP quasi-isotropic"),
    ),
)
