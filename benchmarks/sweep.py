"""What a sweep costs beside its runs, and what a second worker gains.

All from one process and its children, so that ratios hold on a busy machine; medians over repeats
taken in turn.

    python benchmarks/sweep.py [--repeats 3] [--trials 2000]

- the runs alone: built and learned one after the other in this process, recorded nowhere;
- one worker: the same by `sweep`, in this process, with folders, results and table;
- two workers: the same by two processes that have been started before;
- memory: what a worker process grows by, once it has been warmed up;
- a message, a row, a trial: what is sent to a worker, what comes back, what is written;
- passing on: processor time that a run costs the sweep, and the scheduler of a Dask cluster on this
  machine, beside what its worker does. Taken with runs of one trial, where little else happens.
"""

from __future__ import annotations

import argparse
import contextlib
import itertools
import pickle
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import psutil

from drake_viapoint.runs.cluster import cluster_workers
from drake_viapoint.runs.learning_run import learn
from drake_viapoint.runs.memory_log import MemoryLog
from drake_viapoint.runs.run_folder import write_run
from drake_viapoint.runs.study import Study
from drake_viapoint.runs.study_file import read_study
from drake_viapoint.runs.study_log import StudyLog
from drake_viapoint.runs.study_run import StudyWork, execute
from drake_viapoint.runs.sweep import sweep
from drake_viapoint.runs.task_run import versions
from drake_viapoint.runs.workers import LocalWorkers, Workers
from drake_viapoint.tasks.catalogue import TASKS, TaskBuilder
from drake_viapoint.tasks.scenario import make_scenario

PORT = 18786  # of the scheduler
STUDY = """
task: serve
changes: {learning.repeats: 0, disturbance.release: 0.03, disturbance.bounce: 0.03}
conditions:
  fixed: {learning.jacobian.way: fixed}
  recorded: {learning.jacobian.way: recorded}
together:
  demonstration.person: {from: 0, to: 15}
  seed: {from: 0, to: 15}
max_trials: 30
tabulate: [d, landing_error, T_G, success, purpose, subtask]
"""


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=3, help="for the times")
    parser.add_argument("--trials", type=int, default=2000, help="for the memory")
    parser.add_argument("--messages", type=int, default=400, help="runs that are passed on")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        (out / "study.yaml").write_text(STUDY)
        study = read_study(out / "study.yaml")
        time_sweeps(study, out, arguments.repeats)
        weigh_messages(study, out)
        watch_memory(study, out, arguments.trials)
        time_passing_on(out, arguments.messages)


def time_sweeps(study: Study, out: Path, repeats: int) -> None:
    """Throughput of one and two workers, and the overhead of a sweep over its runs."""
    warm = replace(study, together={name: values[:2] for name, values in study.together.items()})
    run_alone(warm)
    sweep(warm, out / "warm", LocalWorkers(2))
    times: dict[str, list[float]] = {}
    for repeat in range(repeats):
        for name, call in (
            ("the runs alone", lambda: run_alone(study)),
            ("one worker", lambda r=repeat: sweep(study, out / f"one{r}", LocalWorkers(1))),
            ("two workers", lambda r=repeat: sweep(study, out / f"two{r}", LocalWorkers(2))),
        ):
            start = time.perf_counter()
            call()
            times.setdefault(name, []).append(time.perf_counter() - start)
    for name, values in times.items():
        print(f"{name:18} {statistics.median(values):7.2f} s for {len(study)} runs")
    gains = [one / two for one, two in zip(times["one worker"], times["two workers"], strict=True)]
    costs = [
        one / alone - 1
        for one, alone in zip(times["one worker"], times["the runs alone"], strict=True)
    ]
    print(f"throughput of two workers / of one   {statistics.median(gains):.2f}")
    print(f"overhead of a sweep over its runs    {statistics.median(costs):+.1%}")


def run_alone(study: Study) -> None:
    """The runs of a study with nothing round about them."""
    builder = TaskBuilder()
    for run in study.runs():
        scenario = make_scenario(study.scenario, TASKS[study.task].scenario, run.changes)
        task = builder.build(scenario)
        log = MemoryLog(run.name)
        learn(task, log, seed=scenario.seed, max_trials=study.max_trials)


def weigh_messages(study: Study, out: Path) -> None:
    """What travels and what is written, a run."""
    runs = list(study.runs())[:4]
    work = StudyWork(study.without_runs(), versions(), send_trials=True)
    results = [execute(work, run) for run in runs]
    trials = sum(len(result.trials or ()) for result in results)
    message = statistics.mean(len(pickle.dumps((work, run))) for run in runs)
    answer = statistics.mean(len(pickle.dumps(result)) for result in results)
    bare = statistics.mean(len(pickle.dumps(result.row)) for result in results)
    seconds = sum(result.row["seconds"] for result in results)
    with StudyLog(out / "rows.jsonl", {"benchmark": "rows"}) as log:
        start = time.perf_counter()
        for result in itertools.islice(itertools.cycle(results), 200):
            log.append(result.row)
        append = (time.perf_counter() - start) / 200
    start = time.perf_counter()
    for number, result in enumerate(itertools.islice(itertools.cycle(results), 100)):
        write_run(out / "written" / str(number), result.scenario, result.trials or ())
    write = (time.perf_counter() - start) / 100
    print(f"a trial            {1e3 * seconds / trials:7.2f} ms, its share of building included")
    print(f"a message          {message / 1e3:7.2f} kB to a worker")
    print(f"a result           {answer / 1e3:7.2f} kB back, of it the row {bare / 1e3:.2f} kB")
    print(f"appending a row    {1e3 * append:7.2f} ms")
    print(f"writing a folder   {1e3 * write:7.2f} ms")


def time_passing_on(out: Path, runs: int) -> None:
    """Processor time a run costs who asks for it, and who passes it on."""
    seeds = list(range(runs))
    (out / "tiny.yaml").write_text(f"task: upswing\nvary: {{seed: {seeds}}}\nmax_trials: 1\n")
    tiny = read_study(out / "tiny.yaml")
    asker = psutil.Process()

    def cost(workers: Workers, name: str, passing: psutil.Process | None = None) -> None:
        before = sum(asker.cpu_times()[:2])
        passed = sum(passing.cpu_times()[:2]) if passing else 0.0
        sweep(tiny, out / name, workers, folders=False)
        own = 1e3 * (sum(asker.cpu_times()[:2]) - before) / runs
        print(f"passing on, {name:6} {own:7.2f} ms of the sweep a run", end="")
        if passing:
            its = 1e3 * (sum(passing.cpu_times()[:2]) - passed) / runs
            print(f", {its:.2f} ms of the scheduler", end="")
        print()

    cost(LocalWorkers(2), "local")
    with contextlib.ExitStack() as closing:
        own = ["--host", "127.0.0.1", "--no-dashboard"]
        scheduler = part(closing, "dask_scheduler", *own, "--port", str(PORT))
        address = f"tcp://127.0.0.1:{PORT}"
        for _ in range(2):
            one = ["--nthreads", "1", "--no-nanny", "--local-directory", str(out / "dask")]
            part(closing, "dask_worker", address, *own, *one)
        time.sleep(10)  # until they have come
        cost(closing.enter_context(cluster_workers(address)), "Dask", scheduler)


def part(closing: contextlib.ExitStack, module: str, *arguments: str) -> psutil.Process:
    """A part of a cluster, as one would start it on any machine."""
    command = [sys.executable, "-m", f"distributed.cli.{module}", *arguments]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    closing.callback(process.wait)
    closing.callback(process.kill)
    return psutil.Process(process.pid)


def watch_memory(study: Study, out: Path, trials: int) -> None:
    """What the processes of the workers grow by."""
    person = {"demonstration.person": (0,)}
    # never learned, so that a run has as many trials as it may
    scenario = {**study.scenario, "learning": {**study.scenario["learning"], "successes": 1000}}
    long = replace(study, scenario=scenario, conditions={"fixed": {}}, together={}, vary=person)
    sizes = []
    for number, seeds in enumerate((range(20), range(20, 20 + max(2, trials // 60)))):
        grown = replace(long, vary={**person, "seed": tuple(seeds)})
        table = sweep(grown, out / f"memory{number}", LocalWorkers(2), folders=False)
        children = psutil.Process().children(recursive=True)
        sizes.append((table["trials"].sum(), [c.memory_info().rss for c in children]))
    (_, before), (made, after) = sizes
    # each of two workers makes about half the trials
    grown_by = [(b - a) / 1e6 / (made / 2 / 1000) for a, b in zip(before, after, strict=True)]
    print(f"memory: {max(grown_by):+.2f} MB a worker and 1000 trials, over {made} trials")


if __name__ == "__main__":
    main()
