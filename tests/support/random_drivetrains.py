"""Random drivetrains in which every number has a name: trees with gears and branches, closed loops, a planetary set."""

import torsionnet as tn


class Draw:
    """Elements and parameters drawn from one source of chance."""

    def __init__(self, source):
        self.random = source
        self.elements, self.parameters = [], {}

    def value(self, name, low, high):
        self.parameters[name] = round(self.random.uniform(low, high), 3)
        return name

    def node(self, i):
        name = f"n{i}"
        if i == 0 or self.random.random() < 0.85:
            self.elements.append(tn.Inertia(f"j{i}", node=name, inertia=self.value(f"J_{i}", 0.05, 2)))
        else:
            self.elements.append(tn.Damper(f"b{i}", nodes=(name, "ground"), damping=self.value(f"b_{i}", 0.1, 3)))
        if self.random.random() < 0.3:
            self.elements.append(tn.Damper(f"d{i}", nodes=(name, "ground"), damping=self.value(f"d_{i}", 0.1, 5)))
        if self.random.random() < 0.15:
            self.elements.append(tn.Spring(f"g{i}", nodes=(name, "ground"), stiffness=self.value(f"g_{i}", 10, 500)))

    def link(self, a, b, i):
        kind, name, nodes = self.random.random(), f"e{i}", (a, b)
        k, c = f"k_{i}", f"c_{i}"
        if kind < 0.5:
            damping = self.random.choice([0, self.value(c, 0.1, 5)])
            element = tn.Spring(name, nodes=nodes, stiffness=self.value(k, 100, 5000), damping=damping)
        elif kind < 0.6:
            eta = self.value(f"eta_{i}", 0.05, 0.3)
            element = tn.HystereticSpring(name, nodes=nodes, stiffness=self.value(k, 100, 5000), loss_factor=eta)
        elif kind < 0.7:
            ratio = self.value(f"t_{i}", 0.5, 4)
            element = tn.Gear(name, nodes=nodes, ratio=ratio, stiffness=self.value(k, 1e3, 1e4))
        elif kind < 0.85:
            element = tn.Gear(name, nodes=nodes, ratio=self.value(f"t_{i}", 0.5, 4))
        else:
            element = tn.RigidCoupling(name, nodes=nodes)
        self.elements.append(element)

    def loop(self, a, b, i):
        k, c = self.value(f"kl_{i}", 100, 5000), self.value(f"cl_{i}", 0.1, 5)
        self.elements.append(tn.Spring(f"l{i}", nodes=(a, b), stiffness=k, damping=c))

    def planetary(self, sun):
        self.elements += [
            tn.Planetary("set", sun=sun, ring="ring", carrier="carrier", ratio=self.value("z", 2, 4)),
            tn.Spring("held", nodes=("ring", "ground"), stiffness=self.value("k_r", 100, 1000)),
            tn.Inertia("load", node="carrier", inertia=self.value("J_c", 0.1, 1)),
        ]

    def sensor(self):
        if self.random.random() < 0.4:
            node = self.random.choice([f"n{i}" for i in range(self.count)])
            return f"{self.random.choice(['angle', 'velocity', 'acceleration'])}({node})"
        return f"{self.random.choice(['twist', 'torque'])}({self.random.choice(self.elements).name})"


def draw(source, loops=0, planetary=False, count=None):
    """(Drivetrain, the Draw it came from)."""
    made = Draw(source)
    made.count = count or made.random.randint(2, 6)
    names = [f"n{i}" for i in range(made.count)]
    for i in range(made.count):
        made.node(i)
    for i in range(1, made.count):
        made.link(names[made.random.randrange(i)], names[i], i)
    for i in range(loops):
        made.loop(*made.random.sample(names, 2), i)
    if planetary:
        made.planetary(made.random.choice(names))
    return tn.Drivetrain("random", made.elements, made.parameters, inputs={"T": {"torque": "n0"}}), made
