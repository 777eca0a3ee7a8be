"""Random drivetrains of any structure with parameters over many decades, as blueprints.

Three-port elements with free, sprung, grounded and locked members, inertias on locked nodes, loops of springs, dampers
and gears (closed consistently where they are rigid), ratios of both signs, massless nodes, shafts.
"""

import random
from fractions import Fraction

from strategies import GROUND, Blueprint, Mechanics, Piece

GROWTH = {
    "elastic": 36,
    "damper": 6,
    "rigid_coupling": 5,
    "rigid_gear": 11,
    "compliant_gear": 10,
    "gear_in_housing": 6,
    "planetary": 14,
    "differential": 9,
    "shaft": 3,
}


def wide_model(seed, count=None, *, lossy=False, decades=None):
    """A blueprint with about ``count`` nodes; ``decades``: half the spread of every kind of parameter."""
    return _Growth(random.Random(seed), count, decades, lossy).blueprint()


class _Growth:
    def __init__(self, source, count, decades, lossy):
        self.random, self.lossy = source, lossy
        self.count = count or source.choice((2, 3, 4, 5, 6, 8, 10, 14))
        self.decades = decades or source.choice((0.5, 2, 4.5, 4.5))
        self.damped, self.heavy = source.choice((0, 0.2, 0.6, 1)), source.choice((0.5, 0.8, 1))
        self.pieces, self.nodes = [], []
        self.body = {}  # node -> (a node it is rigidly geared to, its speed per that of this node)

    # --- values

    def decade(self, middle):
        value = 10 ** (self.random.uniform(-self.decades, self.decades) + middle)
        return Fraction(f"{value:.{self.random.choice((1, 2, 4))}g}")

    def inertia(self):
        return self.decade(-0.5)

    def stiffness(self):
        return self.decade(5.5)

    def damping(self):
        return self.decade(0.5)

    def some_damping(self):
        return self.damping() if self.random.random() < self.damped else Fraction(0)

    def ratio(self):
        size = Fraction(self.random.randint(1, 60), self.random.randint(1, 20))
        return size * self.random.choice((1, -1))

    def ratio_to_a_housing(self):
        return next(tau for tau in iter(self.ratio, None) if tau != 1)

    def mesh(self, compliant):
        if not compliant:
            return {"stiffness": None, "damping": None}
        return {"stiffness": self.stiffness(), "damping": self.some_damping()}

    # --- parts

    def add(self, kind, **values):
        self.pieces.append(Piece(kind, f"{kind}_{len(self.pieces)}", values))

    def fresh(self, carried_by=None, speed=Fraction(1)):
        name = f"n{len(self.nodes)}"
        self.nodes.append(name)
        root, own = self.body[carried_by] if carried_by else (name, Fraction(1))
        self.body[name] = root, own * speed
        return name

    def pair(self, a, b):
        return (a, b) if self.random.random() < 0.5 else (b, a)

    def shuffled(self, *members):
        return self.random.sample(members, len(members))

    def elastic(self, a, b):
        nodes, kind = self.pair(a, b), self.random.random() if self.lossy else 1.0
        if kind < 0.3:
            eta = Fraction(self.random.randint(1, 30), 100)
            self.add("hysteretic_spring", nodes=nodes, stiffness=self.stiffness(), loss_factor=eta)
        elif kind < 0.4:
            at = sorted({Fraction(f"{10 ** self.random.uniform(-1, 3):.2g}") for _ in range(self.random.randint(1, 3))})
            self.add("tabulated_spring", nodes=nodes, table=[[f, self.stiffness(), self.damping()] for f in at])
        else:
            self.add("spring", nodes=nodes, stiffness=self.stiffness(), damping=self.some_damping())

    def grow(self):
        a = self.random.choice(self.nodes[-3:] if self.random.random() < 0.6 else self.nodes)
        getattr(self, f"grow_{self.random.choices(list(GROWTH), list(GROWTH.values()))[0]}")(a)

    def grow_elastic(self, a):
        self.elastic(a, self.fresh())

    def grow_damper(self, a):
        self.add("damper", nodes=self.pair(a, self.fresh()), damping=self.damping())

    def grow_rigid_coupling(self, a):
        self.add("rigid_coupling", nodes=self.pair(a, self.fresh(a)))

    def grow_rigid_gear(self, a):
        tau = self.ratio()
        nodes = (a, self.fresh(a, 1 / tau)) if self.random.random() < 0.5 else (self.fresh(a, tau), a)
        self.add("gear", nodes=nodes, ratio=tau, **self.mesh(compliant=False))

    def grow_compliant_gear(self, a):
        self.add("gear", nodes=self.pair(a, self.fresh()), ratio=self.ratio(), **self.mesh(compliant=True))

    def grow_gear_in_housing(self, a):
        first, second, housing = self.shuffled(a, self.fresh(), self.fresh())
        mesh = self.mesh(compliant=self.random.random() < 0.5)
        self.add("gear", nodes=(first, second), housing=housing, ratio=self.ratio_to_a_housing(), **mesh)
        if self.random.random() < 0.3:
            self.add("lock", node=self.random.choice([node for node in (first, second, housing) if node != a]))

    def grow_planetary(self, a):
        held = self.random.choice(("free", "free", GROUND, "lock", "spring"))
        b, c = self.fresh(), GROUND if held == GROUND else self.fresh()
        sun, ring, carrier = self.shuffled(a, b, c)
        self.add(
            "planetary",
            sun=sun,
            ring=ring,
            carrier=carrier,
            ratio=1 + Fraction(self.random.randint(1, 40), self.random.choice((4, 5, 10, 17))),
            **self.mesh(compliant=self.random.random() < 0.4),
            planets=self.random.randint(1, 5),
            planet_inertia=self.inertia() if self.random.random() < 0.5 else Fraction(0),
            planet_mass=self.inertia() if self.random.random() < 0.4 else Fraction(0),
            orbit_radius=Fraction(self.random.randint(1, 50), 100),
        )
        if held == "lock":
            self.add("lock", node=c)
        elif held == "spring":
            self.elastic(c, GROUND)

    def grow_differential(self, a):
        locked = self.random.random() < 0.2
        others = [self.fresh(a if locked else None) for _ in range(2)]
        cage, left, right = self.shuffled(a, *others)
        self.add("differential", cage=cage, left=left, right=right, locked=locked)
        if not locked and self.random.random() < 0.25:
            self.add("lock", node=self.random.choice(others))

    def grow_shaft(self, a):
        outer = Fraction(self.random.randint(1, 30), 100)
        self.add(
            "shaft",
            nodes=self.pair(a, self.fresh()),
            outer_diameter=outer,
            inner_diameter=outer * self.random.choice((Fraction(0), Fraction(1, 2))),
            length=Fraction(self.random.randint(1, 50), 10),
            shear_modulus=Fraction(793) * 10**8,
            density=Fraction(7850),
            segments=self.random.randint(1, 3),
            inertia=self.random.choice(("consistent", "lumped", "none")),
            damping=self.some_damping(),
        )

    def close(self):
        pairs = [(a, b) for a in self.nodes for b in self.nodes if a < b]
        geared = [(a, b) for a, b in pairs if self.body[a][0] == self.body[b][0]]
        kind = self.random.choice(("elastic", "elastic", "gear", "damper", "consistent", "rigid"))
        if not pairs or (kind in ("consistent", "rigid") and not geared):
            return
        a, b = self.random.choice(geared if kind in ("consistent", "rigid") else pairs)
        if kind == "elastic":
            self.elastic(a, b)
        elif kind == "damper":
            self.add("damper", nodes=(a, b), damping=self.damping())
        elif kind == "gear":
            self.add("gear", nodes=(a, b), ratio=self.ratio(), **self.mesh(compliant=True))
        else:
            tau = self.body[a][1] / self.body[b][1]
            self.add("gear", nodes=(a, b), ratio=tau, **self.mesh(compliant=kind == "consistent"))

    def hold(self):
        a, kind = self.random.choice(self.nodes), self.random.choice(("lock", "lock", "damper", "elastic", "elastic"))
        if kind == "lock":
            self.add("lock", node=a)
        elif kind == "damper":
            self.add("damper", nodes=self.pair(a, GROUND), damping=self.damping())
        else:
            self.elastic(a, GROUND)

    def blueprint(self):
        self.fresh()
        while len(self.nodes) < self.count:
            self.grow()
        for node in self.nodes:
            if self.random.random() < self.heavy:
                self.add("inertia", node=node, inertia=self.inertia())
        for _ in range(self.random.choice((0, 0, 1, 1, 2, 3))):
            self.close()
        for _ in range(self.random.choice((0, 1, 1, 2))):
            self.hold()
        if not Mechanics(self.pieces).degrees_of_freedom:
            self.pieces = [piece for piece in self.pieces if piece.kind != "lock"]
        for node in self.nodes:
            mechanics = Mechanics(self.pieces)
            if mechanics.rank_of("J", "c", "k") == mechanics.degrees_of_freedom:
                break
            self.add("inertia", node=node, inertia=self.inertia())
        return Blueprint(tuple(self.pieces))
