# %% [markdown]
# # A first press
# A ball of clay is pressed dry and wet by the same motion, then by a hand of one's own. Run it as a script, or open it
# as a notebook (editors and Jupytext know the marks `# %%`). It takes some seconds and writes into the folder
# first_press.

# %%
from pathlib import Path

import argil
import argil.plot
import numpy as np

OUT = Path("first_press")
OUT.mkdir(exist_ok=True)

# %% [markdown]
# A motion is a table of time [s] and place [m]: 3 mm into the ball from above, and back.

# %%
time = np.arange(0.0, 0.2505, 0.001)
height = 0.0482 - 0.0032 * np.sin(np.pi * time / time[-1]) ** 2
motion = np.column_stack([time, 0 * time, 0 * time, height])
np.savetxt(OUT / "press.csv", motion, delimiter=",", header="t,x,y,z", comments="", fmt="%.6f")

# %% [markdown]
# A scenario is a dict, or a JSON file for `argil.load`. `argil.reference()` has every key; a wrong one is named with the
# nearest.

# %%
ball = {
    "about": "A ball of clay, pressed from above.",
    "body": {"shape": {"kind": "sphere", "size_m": 0.04, "target_tets": 1500},
             "fixed": [{"kind": "half_space", "normal": [0, 0, 1], "offset_m": 0.006}]},
    "material": {"youngs_modulus_Pa": 1e5, "poissons_ratio": 0.3, "clay_kernel": {"form": "off"},
                 "plasticity": {"strength_Pa": 3000}},
    "tool": {"shape": {"kind": "sphere", "radius_m": 0.008}, "mode": "push"},
    "haptics": {"frame_period_ticks": 25},
    "trace": {"file": "press.csv"},
}
try:
    argil.Scenario(ball, folder=OUT, set={"/material/young": 2e5})
except argil.InputError as error:
    print(error)

# %% [markdown]
# Dry and wet, each to a file: what `argil run` writes, bit for bit. Results are read when they are asked for.

# %%
dry = argil.Scenario(ball, folder=OUT).run(OUT / "dry.h5")
wet = argil.Scenario(ball, folder=OUT, set={"/body/initial_saturation": 0.8}).run(OUT / "wet.h5")
for name, result in (("dry", dry), ("wet", wet)):
    dent = result.frames[0].position - result.frames[-1].position
    print(f"{name}: at most {np.linalg.norm(result.force, axis=1).max():.2f} {result.force.units}, "
          f"a dent of {1e3 * dent[:, 2].max():.2f} mm stays")
argil.plot.save(argil.plot.force(dry, wet, labels=["dry", "wet"]), OUT / "force")
argil.plot.save(argil.plot.energy(dry, wet, labels=["dry", "wet"]), OUT / "energy")

# %% [markdown]
# Tick by tick, with a hand of one's own: it wants to go where the motion goes, and gives way by 0.2 mm for each newton.
# The body's arrays can be read after every tick.

# %%
GIVE = 0.2e-3  # [m/N]


def hand(at, force):
    """Where the hand is at a time [s], when the device renders a force [N]."""
    return np.array([0.0, 0.0, np.interp(at, time, height)]) + GIVE * force


with argil.Scenario(ball, folder=OUT).start(record=OUT / "own.h5") as sim:
    sim.run(sim.num_ticks // 2, hand=hand)
    print(f"half way: force {sim.force[2]:.2f} N, volume ratio at least {sim.physics['min_volume_ratio']:.2f}, "
          f"{np.count_nonzero(np.linalg.norm(sim.plastic_strain, axis=1) > 0.01)} of {len(sim.tets)} tets have flowed")
    sim.run(sim.num_ticks - sim.ticks, hand=hand)
own = argil.open(OUT / "own.h5")
print(f"a hand that gives way feels {own.force[:, 2].max():.2f} N for {dry.force[:, 2].max():.2f} N")
argil.plot.save(argil.plot.force(dry, own, labels=["as the motion goes", "gives way"]), OUT / "own")
