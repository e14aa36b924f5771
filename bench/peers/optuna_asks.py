"""What Optuna's TPE takes to suggest a candidate and to hear of its value, by how many came before: nine gains, as many as
configs/suites/tune-frankie.yaml searches. Prints one line of JSON: us of processor time a candidate."""
import json
import resource
import time
from importlib.metadata import version

import optuna

GAINS, CANDIDATES = 9, 120


def main():
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    startup = time.process_time()
    study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=1, multivariate=True))
    begin = time.process_time()
    for _ in range(CANDIDATES):
        trial = study.ask()
        x = [trial.suggest_float(f"gain{i}", 0.01, 10.0, log=True) for i in range(GAINS)]
        study.tell(trial, sum((value - 1.0) ** 2 for value in x))
    print(json.dumps({"us": 1e6 * (time.process_time() - begin) / CANDIDATES, "startup_s": startup,
                      "rss_mib": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
                      "version": f"Optuna {version('optuna')}"}))


if __name__ == "__main__":
    main()
