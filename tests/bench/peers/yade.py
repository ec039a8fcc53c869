# A bonded packing between two end layers that close, in YADE: `yade -n -x -j1 yade.py PACKING` prints `NS`, the best
# stretch in ns per bond and step. YADE visits bodies in the order in which they were put in, so they are put in along a
# space-filling curve: a random order costs half as much again.
import sys
import time

STEPS, STRETCHES, SKIPPED = 50, 8, 3
SPEED, YOUNG, DENSITY = 0.02, 20e9, 2000.0


def morton(point, low, edge, dimension):
    code = 0
    cells = [int((point[k] - low[k]) / edge * 1023) for k in range(dimension)]
    for bit in reversed(range(10)):
        for cell in reversed(cells):
            code = code << 1 | cell >> bit & 1
    return code


lines = open(sys.argv[1]).read().splitlines()
dimension = int(lines[0].split()[1])
balls = [tuple(map(float, line.split())) for line in lines[1:]]
low = [min(ball[k] for ball in balls) for k in range(3)]
high = [max(ball[k] for ball in balls) for k in range(3)]
edge = max(high[k] - low[k] for k in range(dimension))
balls.sort(key=lambda ball: morton(ball, low, edge, dimension))
mean = sum(ball[3] for ball in balls) / len(balls)

O.materials.append(
    CohFrictMat(
        young=YOUNG, poisson=0.3, density=DENSITY, frictionAngle=0.46, normalCohesion=1e12, shearCohesion=1e12,
        momentRotationLaw=True, etaRoll=-1, etaTwist=-1, alphaKr=1.0, alphaKtw=1.0, isCohesive=True,
    )
)
for x, y, z, radius in balls:
    body = sphere((x, y, z), radius)
    O.bodies.append(body)
    # flow loads along y in the plane and in space.
    end = (y < low[1] + 2 * mean) - (y > high[1] - 2 * mean)
    if end:
        body.state.blockedDOFs = "xyzXYZ"
        body.state.vel = (0, SPEED * end, 0)
    elif dimension == 2:
        body.state.blockedDOFs = "zXY"

factor = 1.001
geometry = Ig2_Sphere_Sphere_ScGeom6D(interactionDetectionFactor=factor)
bounds = Bo1_Sphere_Aabb(aabbEnlargeFactor=factor)
cohesion = Ip2_CohFrictMat_CohFrictMat_CohFrictPhys(setCohesionNow=True, setCohesionOnNewContacts=False)
law = Law2_ScGeom6D_CohFrictPhys_CohesionMoment(useIncrementalForm=True)
O.engines = [
    ForceResetter(),
    InsertionSortCollider([bounds]),
    InteractionLoop([geometry], [cohesion], [law]),
    NewtonIntegrator(damping=0.7),
]
O.dt = 0.5 * PWaveTimeStep()
O.run(2, True)
geometry.interactionDetectionFactor = bounds.aabbEnlargeFactor = 1.0
# Seconds of this process: `O.run` polls for its end, which is too coarse, and other work must not count.
ticks = []


def tick():
    ticks.append(time.process_time())


O.engines = O.engines + [PyRunner(command="tick()", iterPeriod=STEPS)]
O.run(STEPS * (STRETCHES + SKIPPED), True)
best = min(after - before for before, after in zip(ticks[SKIPPED - 1 :], ticks[SKIPPED:]))
print("BONDS", O.interactions.countReal())
print("NS", best * 1e9 / STEPS / O.interactions.countReal())
