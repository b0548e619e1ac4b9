"""The scenes that the page offers under names of their own. The first is shown when it opens."""

from __future__ import annotations

EXAMPLES: dict[str, str] = {
    "tungsten-carbide-ball": """
title = "Tungsten-carbide ball on a mild-steel slab (Big-Alabo et al. 2017, Table 2)"
[impactor]
radius = "10 mm"
mass = "60.74 g"
velocity = "0.25 m/s"
material = "WC, Big-Alabo 2017"
[target]
kind = "half-space"
[target.material]
name = "mild steel of the paper"
youngs_modulus = "210 GPa"
poissons_ratio = 0.30
density = "7850 kg/m^3"
yield_strength = "1.0 GPa"
[contact]
law = "big-alabo"
""",
    "ball-on-composite-plate": """
title = "Ball on a composite plate (Olsson; Big-Alabo et al. 2017, Table 4)"
[impactor]
radius = "6.35 mm"
mass = "8.3 g"
velocity = "3 m/s"
[target]
kind = "plate"
mass_per_area = "4.132 kg/m^2"
bending_stiffness = { D11 = "154.9 N*m", D12 = "4.76 N*m", D22 = "91.4 N*m", D66 = "8.97 N*m" }
[contact]
law = "hertz"
effective_modulus = "9.72 GPa"
""",
    "ball-on-plate": """
title = "Steel ball on a large aluminium plate"
[impactor]
radius = "5 mm"
velocity = "2 m/s"
material = "bearing steel"
[target]
kind = "plate"
thickness = "10 mm"
material = "aluminium 6061-T6"
""",
    "drop-test-on-glass": """
title = "Steel ball dropped on a large pane of glass"
[impactor]
radius = "5 mm"
drop_height = "100 mm"
material = "bearing steel"
[target]
kind = "plate"
thickness = "6 mm"
material = "soda-lime glass"
""",
    "shot-peening": """
title = "Shot peening of aluminium"
[impactor]
radius = "0.3 mm"
velocity = "60 m/s"
material = "bearing steel"
[target]
kind = "half-space"
material = "aluminium 2024-T3"
""",
    "hail": """
title = "Hailstone on a thick aluminium plate"
[impactor]
radius = "10 mm"
velocity = "20 m/s"
[impactor.material]
name = "ice"
youngs_modulus = "9 GPa"
poissons_ratio = 0.33
density = "900 kg/m^3"
yield_strength = "10 MPa"
source = "nominal values at -10 degrees Celsius; ice breaks, which no law here describes"
[target]
kind = "half-space"
material = "aluminium 6061-T6"
""",
    "ball-on-rod": """
title = "Steel ball on the end of a long aluminium rod"
[impactor]
radius = "5 mm"
velocity = "1 m/s"
material = "bearing steel"
[target]
kind = "rod"
diameter = "20 mm"
material = "aluminium 6061-T6"
""",
    "ball-on-beam": """
title = "Steel ball on a steel beam between supports"
[impactor]
radius = "5 mm"
velocity = "1 m/s"
material = "bearing steel"
[target]
kind = "beam"
length = "200 mm"
width = "20 mm"
thickness = "5 mm"
material = "mild steel"
""",
    "ball-on-structure": """
title = "Steel ball on a bracket known by its vibrations"
[impactor]
radius = "10 mm"
velocity = "1 m/s"
material = "bearing steel"
[target]
kind = "structure"
frequency = ["708.04 Hz", "2453.4 Hz", "4890.1 Hz", "9012.7 Hz"]
modal_mass = ["13 g", "46.8 g", "28.6 g", "51.5 g"]
damping_ratio = 0.002
static_compliance = "4.2e-6 m/N"
material = "aluminium 6061-T6"
[contact]
law = "hertz"
""",
    "two-balls": """
title = "A steel ball overtakes a larger one"
[impactor]
radius = "10 mm"
velocity = "0.5 m/s"
material = "bearing steel"
[target]
kind = "body"
radius = "20 mm"
velocity = "0.1 m/s"
material = "bearing steel"
""",
}
