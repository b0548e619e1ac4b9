"""The rows of the catalogue of materials, each value with its source: metals are in `metals`."""

from __future__ import annotations

from film_model.base.material_row import BRITTLE, DAMPING, Row
from film_model.base.metals import METALS

_PAPER = "Big-Alabo, Cartmell & Harrison 2017, Table 2"
_POLYMER = "nominal handbook value at room temperature and slow loading"
_GLASS = "EN 572-1 (elastic constants, density), {} (characteristic strength in bending)"
_TOUGHNESS = "fracture toughness by spherical indentation: Warren 1995, J. Eur. Ceram. Soc. 15:201"
_GENT = "modulus from the hardness: Gent 1958, Rubber Chem. Technol. 31:896, density typical of the kind, ±5 %"
_RUBBER = "10 to 100 Hz, faster impacts lose more: materialmap.github.io/rubber_damping_reference.html"
_WOOD = "Hearmon 1948, in Kollmann & Côté 1968 (radial modulus), as isotropic, along the grain 6 to 20 times stiffer"
_PLY = "Daniel & Ishai 2006, table A.4, modulus across the plies, as isotropic: for the contact, not for bending"
_CARBIDE = "nominal handbook value of sintered grades, Poisson's ratio 0.21 to 0.24"
_CERAMIC = "Callister, Materials Science and Engineering, appendix B; breaks before it yields"
_PLASTIC = "Callister, Materials Science and Engineering, appendix B, middle of the range"
_NO_HARDNESS = (
    "no hardness: numbers of ISO 2039-1 are over the depth under load, H/2.8 would be about 0.6 of the yield strength"
)
_ASHBY = "loss factor: 0.04 GPa/E, Ashby, Materials Selection in Mechanical Design, within a factor of 2"
_LOSS_ALONE = f"{_ASHBY}; {_NO_HARDNESS}"

ROWS: tuple[Row, ...] = (
    *METALS,
    Row("tungsten carbide", 600, 0.22, 14500, None, _CARBIDE, words=("WC", "cemented carbide")),
    Row("WC, Big-Alabo 2017", 600, 0.28, 14500, None, _PAPER),
    Row(
        "alumina",
        370,
        0.22,
        3900,
        None,
        BRITTLE + " (99 % pure)",
        tensile=262,
        more=f"tensile strength: data sheet of CoorsTek AD-995; {_TOUGHNESS}",
        toughness=3.7,
        words=("Al2O3", "aluminium oxide"),
    ),
    Row(
        "zirconia",
        210,
        0.30,
        6050,
        None,
        BRITTLE + " (yttria-stabilised)",
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
        BRITTLE + " (bearing grade)",
        words=("Si3N4",),
    ),
    Row(
        "silicon carbide",
        393,
        0.17,
        3100,
        None,
        "Dowling, Mechanical Behavior of Materials, table 3.10, reaction-bonded",
        tensile=307,
        more="Poisson's ratio: Callister, appendix B; tensile strength: Dowling",
        words=("SiC",),
    ),
    *(
        Row(
            name,
            modulus,
            ratio,
            density,
            None,
            _CERAMIC,
            tensile=tensile,
            more="strength in bending: the same",
            words=words,
        )
        for name, modulus, ratio, density, tensile, words in (
            ("fused silica", 73, 0.17, 2200, 104, ("quartz glass", "SiO2")),
            ("borosilicate glass", 70, 0.20, 2230, 69, ("pyrex",)),
            ("glass-ceramic", 120, 0.25, 2600, 123, ("pyroceram",)),
        )
    ),
    Row(
        "soda-lime glass",
        70,
        0.22,
        2500,
        None,
        BRITTLE,
        loss=1e-3,
        tensile=45,
        more=f"strength of annealed glass in bending: characteristic value of EN 572-1; {_TOUGHNESS}; {DAMPING}",
        toughness=0.71,
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
        more=f"{_TOUGHNESS}; {DAMPING}",
        toughness=0.71,
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
        more=DAMPING,
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
        more="tensile strength: mean of Petrovic 2003, J. Mater. Sci. 38:1; surface energy: Ketcham & Hobbs 1969; "
        "crushing strength: at 10 1/s and -11 °C, from 8.9 MPa at 1 1/s as the power 0.15 of the rate, Jones 1997, "
        "J. Phys. Chem. B 101:6099",
        crushing=12.6,
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
        more=f"tensile and crushing strength: f_ctm and f_cm of EN 1992-1-1, table 3.1; {DAMPING}",
        crushing=38,
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
        "marble",
        55.8,
        0.25,
        2700,
        None,
        "Goodman 1989, Introduction to Rock Mechanics: Cherokee marble, density nominal",
        tensile=1.79,
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
        more=f"{DAMPING}; {_NO_HARDNESS}; surface energy: Wu 1982, Polymer Interface and Adhesion",
        words=("acrylic", "acrylic glass", "plexiglas", "plexiglass", "perspex", "polymethyl methacrylate"),
    ),
    Row(
        "polycarbonate",
        2.4,
        0.37,
        1200,
        62,
        _POLYMER,
        loss=0.017,
        more=_LOSS_ALONE,
        words=("PC", "makrolon", "lexan"),
    ),
    *(
        Row(
            name,
            modulus,
            ratio,
            density,
            strength,
            _PLASTIC,
            loss=round(0.04 / modulus, 3),
            more=_LOSS_ALONE,
            words=words,
        )
        for name, modulus, ratio, density, strength, words in (
            ("polyethylene, high density", 1.08, 0.46, 959, 30, ("HDPE", "PE-HD")),
            ("polypropylene", 1.35, 0.40, 905, 34, ("PP",)),
            ("PVC, rigid", 3.3, 0.38, 1440, 43, ("PVC", "polyvinyl chloride")),
            ("PET", 3.4, 0.33, 1350, 59, ("polyester", "polyethylene terephthalate")),
            ("polystyrene", 2.8, 0.33, 1050, None, ("PS",)),
        )
    ),
    *(
        Row(
            name,
            modulus,
            0.35,
            density,
            strength,
            _POLYMER,
            loss=round(0.04 / modulus, 3),
            more=_LOSS_ALONE,
            words=words,
        )
        for name, modulus, density, strength, words in (
            ("polyoxymethylene", 3.1, 1410, 69, ("POM", "acetal", "delrin")),
            ("ABS", 2.3, 1050, 40, ("acrylonitrile butadiene styrene",)),
        )
    ),
    Row(
        "nylon 6/6",
        2.9,
        0.40,
        1140,
        80,
        _POLYMER + ", dry",
        loss=0.014,
        surface=0.0465,
        more=f"{_LOSS_ALONE}; surface energy: Wu 1982, Polymer Interface and Adhesion",
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
            loss=0.1,
            surface=0.0355,
            more=f"loss factor: 0.05 to 0.15, {_RUBBER}; surface energy: Johnson, Kendall & Roberts 1971",
            words=(f"rubber {hardness} Shore A", f"NR {hardness} Shore A"),
        )
        for hardness, modulus in ((40, 1.69e-3), (50, 2.46e-3), (60, 3.61e-3), (70, 5.52e-3))
    ),
    *(
        Row(
            f"polyurethane {hardness} Shore A",
            modulus,
            0.499,
            1150,
            None,
            _GENT,
            loss=0.12,
            more=f"loss factor: 0.05 to 0.2, {_RUBBER}",
            words=(f"PU {hardness} Shore A",),
        )
        for hardness, modulus in ((80, 9.35e-3), (90, 20.8e-3))
    ),
    Row("beech, across the grain", 2.24, 0.30, 750, None, _WOOD, loss=0.01, more=DAMPING, words=("beech",)),
    Row("spruce, across the grain", 0.71, 0.30, 390, None, _WOOD, loss=0.01, more=DAMPING, words=("spruce",)),
    Row("carbon/epoxy UD", 10.3, 0.30, 1600, None, f"AS4/3501-6: {_PLY}", words=("CFRP UD", "carbon/epoxy")),
    Row(
        "carbon/epoxy quasi-isotropic",
        10.3,
        0.30,
        1600,
        None,
        f"AS4/3501-6: {_PLY}",
        words=("CFRP", "CFRP quasi-isotropic"),
    ),
    Row("glass/epoxy UD", 10.4, 0.30, 1970, None, f"E-glass/epoxy: {_PLY}", words=("GFRP UD", "glass/epoxy")),
    Row(
        "glass/epoxy quasi-isotropic",
        10.4,
        0.30,
        1970,
        None,
        f"E-glass/epoxy: {_PLY}",
        words=("GFRP", "GFRP quasi-isotropic"),
    ),
)
