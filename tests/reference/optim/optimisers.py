"""Success rates of scipy's global optimisers on the standard functions, to compare with
`cargo bench --bench optimisers -- standard`.

A run is a success when a value <= 1e-6 was evaluated within the budget; the number printed beside the
successes is the median count of evaluations until then. Defaults of scipy, except that the budget, and
nothing else, ends a run: differential_evolution with its final polish gets the last tenth of the budget
for it, dual_annealing restarts inside by itself.

Run with numpy 2.4.6 and scipy 1.17.1; needs a minute or two.
"""
import numpy as np
from scipy import optimize

SOLVED, REPEATS = 1e-6, 20
BUDGETS = {7: 20_000, 20: 100_000}


def ackley(x):
    return 20 - 20*np.exp(-.2*np.sqrt(np.mean(x*x))) + np.e - np.exp(np.mean(np.cos(2*np.pi*x)))


FUNCTIONS = {
    "sphere": (5.12, lambda x: np.sum(x*x)),
    "rosenbrock": (2.048, lambda x: np.sum(100*(x[1:] - x[:-1]**2)**2 + (1 - x[:-1])**2)),
    "rastrigin": (5.12, lambda x: np.sum(x*x + 10 - 10*np.cos(2*np.pi*x))),
    "ackley": (32.768, ackley),
}


class Enough(Exception):
    pass


def counted(f, budget):
    """f that stops the run when it is solved or the budget is used; box.n counts, box.ok says which."""
    class Box:
        n, ok = 0, False

    def g(x):
        if Box.n >= budget:
            raise Enough
        Box.n += 1
        v = float(f(np.asarray(x)))
        if v <= SOLVED:
            Box.ok = True
            raise Enough
        return v
    return g, Box


def differential_evolution(f, bounds, budget, seed):
    population = 15*len(bounds)
    generations = int(.9*budget/population) - 1
    return optimize.differential_evolution(f, bounds, maxiter=generations, rng=np.random.default_rng(seed))


def dual_annealing(f, bounds, budget, seed):
    return optimize.dual_annealing(f, bounds, maxiter=10**7, maxfun=10**9, rng=np.random.default_rng(seed))


if __name__ == "__main__":
    methods = [differential_evolution, dual_annealing]
    print(f"successes of {REPEATS} (value <= {SOLVED:g}) and median evaluations to it")
    print(f"{'function':12} {'d':>3} {'budget':>7} " + "".join(f"{m.__name__:>24}" for m in methods))
    for name, (half, f) in FUNCTIONS.items():
        for d, budget in BUDGETS.items():
            line = f"{name:12} {d:3} {budget:7} "
            for method in methods:
                used = []
                for seed in range(REPEATS):
                    g, box = counted(f, budget)
                    try:
                        method(g, [(-half, half)]*d, budget, seed)
                    except Enough:
                        pass
                    if box.ok:
                        used.append(box.n)
                line += f"{len(used):>16} {sorted(used)[len(used)//2] if used else '-':>7}"
            print(line, flush=True)
