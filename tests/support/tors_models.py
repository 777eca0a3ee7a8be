"""Random drivetrains that the TORS format can express, and a file with every type of element in it."""

import torsionnet as tn

THRUSTER = {
    "name": "thruster",
    "date": "2020-01-01",
    "components": [
        {
            "name": "motor",
            "elements": [
                {
                    "name": "rotor",
                    "type": "Disk",
                    "inertia": 0.8,
                    "damping": 2.0,
                    "excitation": {"type": "harmonic", "values": [[1, 2], [3, 4]]},
                },
                {"name": "fan", "type": "Disk", "inertia": 0.15, "damping": 0.5},
                {"name": "coupling", "type": "ShaftDiscrete", "stiffness": 8000.0, "damping": 6.0},
                {"name": "hub", "type": "Disk", "inertia": 0.05, "damping": 0.0},
            ],
        },
        {
            "name": "gearbox",
            "elements": [
                {"name": "pinion", "type": "GearElement", "inertia": 0.02, "diameter": 68.0, "teeth": 17},
                {
                    "name": "wheel 1",
                    "type": "GearElement",
                    "inertia": 0.3,
                    "diameter": 160.0,
                    "teeth": 40,
                    "parent": "pinion",
                },
                {
                    "name": "wheel 2",
                    "type": "GearElement",
                    "inertia": 0.1,
                    "diameter": 92.0,
                    "teeth": 23,
                    "parent": "pinion",
                },
            ],
        },
        {
            "name": "propeller",
            "elements": [
                {
                    "name": "shaft",
                    "type": "ShaftContinuous",
                    "length": 1500.0,
                    "outerDiameter": 70.0,
                    "innerDiameter": 30.0,
                    "damping": 0,
                },
                {
                    "name": "tail",
                    "type": "ShaftContinuous",
                    "length": 800.0,
                    "outerDiameter": 60.0,
                    "innerDiameter": 0.0,
                    "damping": 0,
                    "density": 7850.0,
                },
                {"name": "disk", "type": "Disk", "inertia": 3.0, "damping": 25.0},
            ],
        },
        {
            "name": "pump",
            "elements": [
                {"name": "shaft", "type": "ShaftDiscrete", "stiffness": 21000.0, "damping": 1.5},
                {"name": "disk", "type": "Disk", "inertia": 0.4, "damping": 1.0},
            ],
        },
    ],
    "structure": [
        ["motor.hub", "gearbox.pinion"],
        ["gearbox.wheel 1", "propeller.shaft"],
        ["gearbox.wheel 2", "pump.shaft"],
    ],
}


def random_tree(random, count):
    """A tree of shafts and gears: from every node at most one shaft leads on, and any number of gears."""
    elements = [tn.Inertia("j0", node="n0", inertia=random.uniform(0.1, 2))]
    has_shaft = set()
    for i in range(1, count):
        free = [k for k in range(i) if k not in has_shaft]
        kind = random.choice(["spring", "shaft", "lumped", "gear", "teeth"]) if free else "gear"
        parent = random.choice(free) if kind in ("spring", "shaft", "lumped") else random.randrange(i)
        nodes = (f"n{parent}", f"n{i}") if random.random() < 0.5 else (f"n{i}", f"n{parent}")
        if kind == "spring":
            k, c = random.uniform(1e3, 1e4), random.choice([0, random.uniform(0, 9)])
            elements.append(tn.Spring(f"e{i}", nodes=nodes, stiffness=k, damping=c))
            if random.random() < 0.3:
                elements.append(tn.Damper(f"p{i}", nodes=nodes[::-1], damping=random.uniform(1, 9)))
        elif kind == "gear":
            ratio = random.choice([-1, 1]) * random.uniform(0.3, 3)
            elements.append(tn.Gear(f"e{i}", nodes=nodes, ratio=ratio))
        elif kind == "teeth":
            teeth = (random.randrange(12, 80), random.choice([-1, 1]) * random.randrange(12, 80))
            elements.append(tn.Gear(f"e{i}", nodes=nodes, teeth=teeth))
        else:
            size = {"outer_diameter": random.uniform(0.05, 0.08), "length": random.uniform(0.5, 2)}
            inner = random.choice([0, 0.03])
            model = "lumped" if kind == "lumped" else "consistent"
            more = {"segments": random.randrange(1, 4), "inertia": model, "shear_modulus": random.choice([8e10, 7e10])}
            elements.append(tn.Shaft(f"e{i}", nodes=nodes, inner_diameter=inner, **size, **more))
        if kind in ("spring", "shaft", "lumped"):
            has_shaft.add(parent)
        elements.append(tn.Inertia(f"j{i}", node=f"n{i}", inertia=random.uniform(0.1, 2)))
        if random.random() < 0.4:
            elements.append(tn.Damper(f"d{i}", nodes=(f"n{i}", "ground"), damping=random.uniform(0.1, 5)))
    return tn.Drivetrain("tree", elements)
