# Writes specimen.data, which LAMMPS reads, from the lists that `flow export --to particles` makes.
import csv


def rows(name):
    with open(name) as file:
        return list(csv.DictReader(file))


balls, contacts = rows("specimen.csv"), rows("contacts.csv")
at = [[float(ball[name]) for name in ("x [m]", "y [m]", "radius [m]", "density [kg/m^3]")] for ball in balls]
margin = 0.2 * (max(y for _, y, *_ in at) - min(y for _, y, *_ in at))
layer = max(r for *_, r, _ in at)
with open("specimen.data", "w") as out:
    print("discs and their contacts, by flow\n", file=out)
    print(f"{len(at)} atoms\n{len(contacts)} bonds\n1 atom types\n1 bond types", file=out)
    print("16 extra bond per atom\n32 extra special per atom", file=out)
    for axis, index in (("x", 0), ("y", 1)):
        values = [row[index] for row in at]
        print(f"{min(values) - margin!r} {max(values) + margin!r} {axis}lo {axis}hi", file=out)
    print(f"{-4 * layer!r} {4 * layer!r} zlo zhi\n\nAtoms # bpm/sphere\n", file=out)
    for number, (x, y, r, density) in enumerate(at, 1):
        print(f"{number} 1 1 {2 * r!r} {density!r} {x!r} {y!r} 0.0", file=out)
    print("\nBonds\n", file=out)
    for number, contact in enumerate(contacts, 1):
        print(f"{number} 1 {int(contact['first']) + 1} {int(contact['second']) + 1}", file=out)
