"""The words of docs/coupling.md; its numbers are in the tables, which are made from the committed rows."""

HEAD = """\
# Coupling an engine

An engine in front of the module is a partner in a loop. Either its speed goes to the module and the input torque comes
back, or, with the parameter `drive` = torque, its torque goes to the module, which carries its rotor, and the speed comes
back (below). `inertia_module.cosimulation` has an engine (rotor, limits of torque over speed, sampled
governor), the schemes that couple it, the energy lost between both, and an adaptive communication step:

```python
from inertia_module.cosimulation import SCHEMES, CoupledEngine, Engine, EngineMap, Governor
from inertia_module.instance import Fmu

limits = EngineMap(speed=(0.0, 200.0, 400.0), greatest=(120.0, 170.0, 140.0), drag=(10.0, 15.0, 25.0))
engine = Engine(0.15, limits, Governor(4.0, 20.0), reference=200.0, speed=200.0)
with Fmu("build/InertiaModule.fmu", {"output_inertia": 1.0}, {"omega1": 200.0, "load_torque": 8.0}) as fmu:
    coupled = CoupledEngine(fmu, engine, SCHEMES["implicit ramp"])
    for _ in range(1000):
        coupled.advance(0.001)
    print(engine.speed, fmu["omega_out"], coupled.ledger.defect)
```

A `CoupledEngine` is a plant for [closed loops](scenes.md): its `omega1` is the speed the governor is asked for, and
`substeps` puts communication steps between engine and module within a step of the loop.

`inertia-module coupling` measures all that follows (`--quick`, `--only PART`, `-o DIR`); the rows are
`docs/coupling_*.csv`, and this page is made from them.

![The map of errors](coupling.png)

*Worst of three errors: mean speed of the engine over 20 ms, output speed, energy lost on the bond (share of the
engine's work). Black: unstable. planar is the module of the urban scene at 200 rad/s (a pulse takes 19 ms), bevel is scene
R1 (37 ms). Φ is the greatest inertia the module has at its input, J_E that of the engine.*
"""

RECOMMENDED = """\
## Recommended settings

| the master can | take | communication step |
|---|---|---|
| give the module the engine's torque: its rotor is a number, its governor is sampled | a module driven by torque: `drive` = torque, `TorqueDrivenEngine` | any that divides the governor's sample time, at any Φ/J_E |
| only give a speed; save and restore the FMU, and has its directional derivatives | `implicit ramp` | a quarter of a pulse up to Φ/J_E = 0.1, a tenth up to 0.5, a twentieth up to 2 |
| only give a speed, with its derivative | `inertia module first ramp`: the module first, along the speed extrapolated; the engine reckons with Φ | a fortieth of a pulse, up to Φ/J_E = 1 |
| only give a held speed (most masters of many FMUs, with an engine that has its own rotor) | `input_torque_mean`, the module first (Gauss-Seidel) where there is a choice; J_E > 2 Φ | as short as can be paid: the energy lost falls with the first power of the step only |

The steps of the schemes by speed keep the speeds and the energy within a percent while the module pulses all the time (a launch); over the urban
cycle, which cruises locked up, the energy then closes far better (below).

- **Step means always**, never `input_torque`: an instantaneous torque of a held speed does not contain the inertia of the
  module at all, at any step, and with steps over a tenth of a pulse it aliases.
- **Derivatives only with the right order.** A ramp is worth an order with the module first. With Jacobi it costs stability and
  gains little.
- **Engine first is no better than module first** without a correction: the torque then is a step old.
- Watch `ledger.defect` (both accounts) or the residual of the bond (exchanged values): they tell the error without a reference.
- **Behind the module** it is the other way round: towards an elastic shaft take the instantaneous `shaft_torque` with its
  derivative, module first (below).
"""

TORQUE_DRIVEN = """\
## A module driven by torque

With the parameter `drive` = torque the input is `drive_torque`, the speed of link 1 is a state, and `input_speed` answers.
`input_inertia` then carries the rotor of the engine too and must be above 0; `omega1` is only the speed at the start. What is
left of the engine is its map and its governor, and they exchange what is smooth: a torque that is held from sample to sample,
and a speed. No pulse crosses the bond, so there is no added-mass limit, and no energy can be lost on it.

```python
from inertia_module.cosimulation import Engine, EngineMap, Governor, TorqueDrivenEngine, torque_driven
from inertia_module.instance import Fmu

limits = EngineMap(speed=(0.0, 200.0, 400.0), greatest=(120.0, 170.0, 140.0), drag=(10.0, 15.0, 25.0))
engine = Engine(0.15, limits, Governor(4.0, 20.0, 0.005), reference=200.0, speed=200.0)
parameters = torque_driven({{"output_inertia": 1.0}}, engine.inertia)  # drive, and the rotor in input_inertia
with Fmu("build/InertiaModule.fmu", parameters, {{"omega1": 200.0, "load_torque": 8.0}}) as fmu:
    coupled = TorqueDrivenEngine(fmu, engine)
    for _ in range(200):
        coupled.advance(0.005)
    print(engine.speed, fmu["omega_out"], coupled.ledger.defect)
```

**When to use it:** wherever the torque is what you have. Where every sample of the governor falls on a communication point it
is the one-piece reference: all errors of the map's launches are below {exact} % at steps up to the sample time of {sample:g} ms, at
any Φ/J_E from 0.1 to 5. At that step a simulated second takes {cheaper} of the time that `implicit ramp` takes at 1 ms, which
is {implicit} % off there (Φ/J_E = {ratio:g}). It needs neither states nor derivatives of the FMU, so any master will do.

**When not:**

- The engine is a model with a rotor of its own, which takes a torque and gives a speed; or a motor so stiffly controlled that its
  speed is given. Then the module has to be driven by speed, with a scheme as above.
- Steps that miss samples: the governor sees the speed late. 2 ms, which does not divide 5 ms, is up to {miss} % off, and 10 ms up to
  {late} %. No energy is lost by it, but the engine is another one.
- A spring between engine and link 1, such as a dual-mass flywheel: its torque follows a speed by an integral and is not
  held, so the limit is that of a shaft behind the module (below), with the inertia of link 1 for the hub's (by reasoning: not
  measured).
- `fidelity` = kinematic, where the motion is prescribed: it is refused.
"""

TORQUE_ERRORS = """\
**{case}**, driven by torque: errors of ω1 / ω_out / work of the engine, %, over Φ/J_E (<: rounding and tolerance)
"""

TORQUE_COST = """\
What it costs, at Φ/J_E = {ratio:g}. Time: of a simulated second of the launch in Python, all calls included, median of runs that
take turns; the second number is in units of that of the module driven by torque at 5 ms, median of ratios within a turn.
Energy: lost on the bond.
"""

LIMITS = """\
## The added-mass limit

Let a jump of ω1 meet the inertia Φ = J1 + I + 2kB + k²G (link 2 held, the most there is) and r = Φ/J_E. The step mean
holds all impulses, h T = Φ m with m the change of the module's speed, and the engine answers with u = −h T/J_E. The step
cancels out: **engine and module exchange momentum, and shorter steps do not help**. With m = u of the step before the growth
in a step is −r, so r < 1. Each scheme has a characteristic polynomial (`cosimulation/amplification.py`):

| what the module gets | Jacobi | engine first | module first |
|---|---|---|---|
| held speed | λ² + r = 0: r < 1 | λ + r = 0: r < 1 | λ + r = 0: r < 1 |
| ramp (extrapolated; engine first: known) | λ³ + 2rλ − r = 0: r < √2 − 1 | λ + r = 0: r < 1 | λ² + 2rλ − r = 0: r < 1/3 |
| mean speed of the engine's step | | λ² + r(λ + 1)/2 = 0: r < 2 | |

**Inertia correction.** An engine that takes T + Φ̃ (a − â) for its load, T and â being the module's torque and acceleration in
its last step and a its own acceleration, has r − ρ for r and 1 + ρ for 1, ρ = Φ̃/J_E: held, the growth is
(Φ̃ − Φ)/(J_E + Φ̃). With Φ̃ midway between the extremes of Φ over a turn it is below 1 for every engine. `interface_inertia`
gives it. As Φ̃ is constant the impulses it moves from step to step add up to nothing.

**Implicit.** The step is tried, h ∂T/∂ω1 of `fmi2GetDirectionalDerivative` is the inertia met, the engine's own step with that
inertia gives the speed to end at, and the step is taken back and made again. For an inertia this is exact.

Measured on a module that is an inertia of 0.1 kg·m² and nothing else, with an engine that gets a step of torque ("none":
stable up to Φ/J_E = {greatest:g}; inertia felt: share of Φ that slows the engine down in the end):
"""

MAP = """\
A real module's Φ pulsates, and is least where the imbalance is near the pole. A scheme whose limit lies between may hold on
average and still be useless: pulses are amplified where Φ is large.

## The map

The reference is engine and module in one piece: Lagrange's equations with both speeds as states, inertias from positions
by rotation matrices, SciPy's DOP853 from event to event (`studies/coupling/monolithic.py`; nothing of the kernel). The
FMU coupled by `implicit ramp` with six corrections tends to it with the square of the step: at 20 µs they differ by
8e-7 of the engine's speed and 3e-7 of the output speed. The launch lasts 1 s; the governor is sampled every 5 ms.
"""

INDICATOR = """\
## The residual of the bond as an indicator

Sum of |h (T_E ω_E − T_M ω_M)|, of exchanged means, over the engine's work, against the errors in ω1 and ω_out and the energy
lost, on logarithmic scales over all stable runs of the map. It needs no reference and no audit in the FMU. It tells most
where both sides have the torque of the same step, with the module first or implicit; where the engine has that of the step
before, what only goes to and fro outweighs what is lost.
"""

ADAPTIVE = """\
## An adaptive step (ECCO)

`run_adaptive` lets the residual of the power bond, h (T_E ω_E − T_M ω_M) of exchanged means, set the next step (Sadjina et
al. 2017; PI controller of Gustafsson). No step is taken back. The case: launch, lock-up and cruise over {stop:g} s at
Φ/J_E = {ratio:g}; the pulses cease on the way. Errors: adaptive / equal steps of the same number. Explicit schemes gain
up to a factor of ten and more once the tolerance is 1e-5 or tighter; with tolerances that let a step be a quarter of a pulse
nothing helps. `implicit ramp` gains nothing: what it leaves on the bond is hardly an error. Where pulses go on all the time
there is nothing to adapt to but their phase. (Errors of some percent here are mostly the moment of lock-up, which a
little lost energy moves by a pulse.)
"""

URBAN = """\
## The urban cycle

`examples/urban.toml` with an engine of 0.15 kg·m² in front (idling at 80 rad/s, Φ/J_E = 0.43), closed loop: the driver's controller
sets the governor's speed every 10 ms, engine (governor sampled every 5 ms) and module exchange in the steps given. Engine = load + stored + not accounted
for; gross: the sum of what is lost or made in each step, without its sign. Every step of the FMU keeps its own balance
to 1e-8: what is missing is lost between the two.
"""

SHAFTS = """\
## Module and driven shaft as two FMUs

Nothing impulsive passes behind the module: a spring answers a speed with an integral. What limits the step is the swing
of the hub on the spring, z = h² c/J3 (`cosimulation.shaft.growth` is the theory):

- **Step means are the wrong choice here**: the mean is a torque of half a step ago, and a late spring makes energy. With the
  mean a free hub is unstable unless d > h c/2; Jacobi is worse.
- **Instantaneous torque, module first** is the symplectic Euler method: stable up to h √(c/J3) = 2, undamped too. With the
  derivative of `shaft_torque` for the load and the hub's known ramp it is of second order, and loses next to no energy.
- **Implicit** (the module tried, taken back; the shaft is linear) is stable up to h √(c/J3) = √12 for a free hub. In the module
  a freewheel may switch between the trial and the step, and above 2 it fails too: not worth its cost.

The reference scene, hub 0.02 and driven mass 0.5 kg·m², over 0.5 s; rms errors of hub / driven mass / energy lost between
both, %. Heading: step, h √(c/J3).

![Two FMUs against one piece](coupling_shafts.png)
"""
