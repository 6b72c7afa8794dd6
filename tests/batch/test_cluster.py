"""Work on a cluster of Dask: the same records as from one process, and what is lost on the way loses nothing."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from threading import Event
from time import sleep
from types import SimpleNamespace

import pytest
from attrs import define
from batch_helpers import Fatal, InlineQueue, Onlooker, records_in, reported, run_in
from test_command import run, started, wait_for_records
from test_run import square

from workhold.batch.store import FolderStore, UrlStore, make_refusal_record, open_store, parse_record
from workhold.batch.tasks import Outcome
from workhold.errors import InputError

pytest.importorskip("distributed", reason="needs distributed")
pytest.importorskip("fsspec", reason="needs fsspec")

TOOLS = ("--pitch", "12,16", "--columns", "1", "--peg-radius", "3", "--toolkit", "vise")
MANY_TOOLS = ("--pitch", "12,16", "--columns", "1,2", "--peg-radius", "3", "--toolkit", "vise")
# What depends on the machine and the moment.
OF_THE_MOMENT = ("seconds", "worker", "record")


@pytest.fixture(scope="module")
def shop(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A dozen parts, one of which cannot be read."""
    folder = tmp_path_factory.mktemp("shop")
    for side in range(30, 41):
        square(folder / f"p{side}.json", side)
    (folder / "broken.dxf").write_text("0\nSECTION\n")
    return folder


def rows_of(folder: Path, name: str) -> list[dict[str, object]]:
    """A table without what depends on the moment."""
    parquet = pytest.importorskip("pyarrow.parquet", reason="needs pyarrow")
    rows = parquet.read_table(folder / name).to_pylist()
    return [{key: value for key, value in row.items() if key not in OF_THE_MOMENT} for row in rows]


def test_a_cluster_makes_what_one_process_makes(shop: Path, tmp_path: Path) -> None:
    """Also where its workers put the records themselves."""
    for words in (("--workers", 1), ("--local-cluster", 2, "--records", tmp_path / "records")):
        code, told, warned = run(shop, *TOOLS, "--out", tmp_path / str(words[0]), *words)
        assert code == 0, warned
        assert told.startswith("24 jobs: 22 held, 2 not readable.")
    alone, cluster = tmp_path / "--workers", tmp_path / "--local-cluster"
    kept = [
        {path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.glob("*/*")}
        for folder in (alone / "work", tmp_path / "records")
    ]
    # Records and their checksums.
    assert kept[0] == kept[1] and len(kept[0]) == 2 * len(records_in(alone)) > 0
    assert not (cluster / "work").exists()
    for name in ("results.parquet", "best.parquet"):
        assert rows_of(alone, name) == rows_of(cluster, name)


def test_records_in_an_object_store_are_those_of_a_folder(shop: Path, tmp_path: Path) -> None:
    store = open_store("memory://workhold-test/batch/")
    assert isinstance(store, UrlStore)
    batch = run_in(tmp_path, shop / "p30.json", queue=InlineQueue(), store=store)
    run_in(tmp_path / "folder", shop / "p30.json", queue=InlineQueue())
    name = batch.jobs[0].name
    assert store.get_location(name) == f"memory://workhold-test/batch/{name[:2]}/{name}.json"
    assert store.read(name) == records_in(tmp_path / "folder")[f"work/{name[:2]}/{name}.json"]
    with store.open_record(name) as path:
        assert path.read_bytes() == store.read(name)
    store.write("abcd", make_refusal_record("no")[:-1])
    assert not store.has("abcd") and store.read("abcd") is None
    assert run_in(tmp_path, shop / "p30.json", queue=InlineQueue(0), store=store).is_complete
    reported(batch, tmp_path, tmp_path, sheets=tmp_path, store=store)
    text = (tmp_path / "r.html").read_text()
    assert store.get_location(name) in text and text.count("<img") == 1 and "workhold sheet" not in text
    assert len(list(tmp_path.glob("*.pdf"))) == 1


def test_a_worker_puts_records_where_they_belong(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import distributed

    from workhold.batch.cluster import run_on_worker

    monkeypatch.setattr(distributed, "get_worker", lambda: SimpleNamespace(address="tcp://worker"))
    task, store = Fatal("abcd", "title", tmp_path, 0), FolderStore(tmp_path / "records")
    back = run_on_worker(task, None)
    assert back.record is not None and back.worker == "tcp://worker"
    put = run_on_worker(task, store)
    assert (put.record, put.failure) == (None, "") and store.read("abcd") == back.record
    (tmp_path / "file").touch()
    lost = run_on_worker(task, FolderStore(tmp_path / "file"))
    assert lost.record is None and "cannot be written" in lost.failure


@pytest.mark.parametrize(
    "address", ["foo", "tcp://", "127.0.0.1:99999", "tcp://:8786", "inproc://x:1", "tcp://a:1x"]
)
def test_words_that_are_no_address_are_refused(address: str) -> None:
    from workhold.batch.cluster import ClusterWorkers

    with pytest.raises(InputError, match="is not an address of a scheduler"):
        ClusterWorkers(Onlooker(), address).__enter__()


def test_stores_are_told_by_their_urls(tmp_path: Path) -> None:
    for url in (str(tmp_path), f"file://{tmp_path}"):
        assert open_store(url) == FolderStore(tmp_path)
    with pytest.raises(InputError, match="odd://bucket cannot be used"):
        open_store("odd://bucket")


@pytest.mark.prove
@pytest.mark.parametrize("patience_of_dask", ["15s", "1ms"])
def test_a_task_that_ends_its_workers_is_given_up_and_others_are_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, patience_of_dask: str
) -> None:
    """Also where Dask has no patience: it gives up workers that do not come back at once, and nobody else starts any."""
    import dask

    from workhold.batch import cluster
    from workhold.batch.cluster import ClusterWorkers

    monkeypatch.setattr(cluster, "PATIENCE", 2.0)
    monkeypatch.setitem(dask.config.config["distributed"]["deploy"], "lost-worker-timeout", patience_of_dask)
    tasks = [Fatal(f"task{n}", f"title {n}", tmp_path, times) for n, times in enumerate((0, 1, 99, 0))]
    onlooker = Onlooker()
    with ClusterWorkers(onlooker, count=2) as queue:
        outcomes = {outcome.name: outcome for outcome in queue.run(iter(tasks), Event())}
    assert set(outcomes) == {task.name for task in tasks}
    assert "workers ended while they worked on this" in outcomes["task2"].failure
    done = [outcome.record for name, outcome in outcomes.items() if name != "task2"]
    assert all(record is not None and "was done" in parse_record(record)["refusal"] for record in done)
    assert sum("is lost" in sentence for sentence in onlooker.sentences) >= 3


@pytest.mark.parametrize(
    ("address", "threads", "started", "words"),
    [
        (None, 1, [2], ""),
        (None, 2, [], ""),
        (None, 0, [2], ""),
        ("a:1", 0, [], "no worker"),
        ("a:1", 1, [], ""),
    ],
)
def test_workers_that_stay_away_are_started_again_on_this_machine(
    monkeypatch: pytest.MonkeyPatch, address: str | None, threads: int, started: list[int], words: str
) -> None:
    """Of a cluster elsewhere it is told that there is none: somebody else starts them there."""
    from workhold.batch import cluster

    now, onlooker, scaled = [100.0], Onlooker(), list[int]()
    monkeypatch.setattr(cluster, "monotonic", lambda: now[0])
    queue = cluster.ClusterWorkers(onlooker, address, count=2)
    queue.client = SimpleNamespace(nthreads=lambda: {str(k): 1 for k in range(threads)})
    queue.own = SimpleNamespace(scale=scaled.append) if address is None else None
    queue.idle_since = 100.0
    for now[0] in (103.0, 110.0, 119.0):
        assert queue.count_threads() == threads
    assert not scaled and not onlooker.sentences
    for now[0] in (121.0, 124.0, 139.0):
        queue.count_threads()
    assert scaled == started and [words in sentence for sentence in onlooker.sentences] == [True] * bool(
        words
    )


@define(eq=False)
class Remade:
    """A task's future whose worker is lost after it was done; another one does it again, or three more are lost."""

    key: str
    task: Fatal
    states: list[str]
    failures: list[Exception]

    @property
    def status(self) -> str:
        return self.states.pop(0) if len(self.states) > 1 else self.states[0]

    def add_done_callback(self, call: Callable[[Remade], None]) -> None:
        call(self)

    def result(self, timeout: float) -> Outcome:
        """The record, after failures to fetch it: too late, or with a connection that ends."""
        assert timeout > 0
        if self.failures:
            raise self.failures.pop(0)
        return Outcome(self.task.name, make_refusal_record("done again"), "")


@pytest.mark.parametrize(
    ("states", "failures"),
    [
        (["finished"], []),
        (["lost", "lost", "finished"], []),
        (["pending", "lost", "finished"], []),
        (["finished"], [TimeoutError(), ConnectionError()]),
    ],
)
def test_what_is_lost_with_its_worker_before_it_is_fetched_is_made_again(
    tmp_path: Path, states: list[str], failures: list[Exception]
) -> None:
    from workhold.batch.cluster import ClusterWorkers

    onlooker = Onlooker()
    queue = ClusterWorkers(onlooker)
    queue.client = SimpleNamespace(
        submit=lambda call, task, store, key, pure: Remade(key, task, list(states), list(failures)),
        nthreads=lambda: {"worker": 1},
        cancel=lambda futures: None,
        status="running",
    )
    tasks = [Fatal(f"task{n}", "title", tmp_path, 0) for n in range(5)]
    assert {one.name for one in queue.run(iter(tasks), Event())} == {task.name for task in tasks}
    assert not queue.gone and not onlooker.sentences


@contextmanager
def scheduler(folder: Path) -> Iterator[tuple[str, subprocess.Popen[bytes], subprocess.Popen[bytes]]]:
    """A scheduler's address, its process, and that of a worker, as they are started on two machines."""
    file = folder / "scheduler.json"
    file.unlink(missing_ok=True)
    commands = (
        ("dask_scheduler", "--port", "0", "--no-dashboard", "--scheduler-file", str(file)),
        ("dask_worker", "--scheduler-file", str(file), "--nthreads", "1", "--no-dashboard"),
    )
    with ExitStack() as stack:
        processes = []
        for module, *words in commands:
            command = [sys.executable, "-m", f"distributed.cli.{module}", *words]
            processes.append(
                subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=folder)
            )
            stack.callback(processes[-1].wait)
            stack.callback(processes[-1].terminate)
            while not file.exists() or not file.read_text().rstrip().endswith("}"):
                assert processes[0].poll() is None
                sleep(0.05)
        yield json.loads(file.read_text())["address"], *processes


@pytest.mark.prove
def test_a_lost_scheduler_is_told_and_the_next_one_goes_on(shop: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    with (
        scheduler(tmp_path) as (address, process, _),
        started(shop, *MANY_TOOLS, "--out", out, "--cluster", address) as command,
    ):
        wait_for_records(command, out)
        os.kill(process.pid, signal.SIGKILL)
        _, error = command.communicate(timeout=300)
    assert command.returncode in (0, 2) and "Traceback" not in error, error
    if command.returncode == 2:
        assert (
            f"the scheduler at {address} is lost. The answers so far are kept: "
            "start the scheduler, and then the same command" in error
        )
        assert f"The scheduler at {address} is lost" in (out / "report.html").read_text()
    with scheduler(tmp_path) as (address, _, _):
        code, _, warned = run(shop, *MANY_TOOLS, "--out", out, "--cluster", address)
    assert code == 0, warned
    run(shop, *MANY_TOOLS, "--out", tmp_path / "alone", "--workers", 1)
    assert records_in(out) == records_in(tmp_path / "alone")


@pytest.mark.prove
def test_nobody_answers(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from workhold.batch import cluster

    monkeypatch.setattr(cluster, "ANSWER", 1)
    code, _, warned = run("widget", *TOOLS, "--out", tmp_path / "out", "--cluster", "tcp://127.0.0.1:1")
    assert code == 2 and "no scheduler answers at tcp://127.0.0.1:1: start one" in warned


@pytest.mark.prove
def test_two_hundred_parts_in_four_toolkits(tmp_path: Path) -> None:
    """On two workers, one of which is killed in the middle, and then the whole run: the same files as from one process."""
    import psutil

    shop = tmp_path / "shop"
    shop.mkdir()
    for number in range(199):
        square(shop / f"p{number}.json", 25 + number * 0.15)
    (shop / "broken.svg").write_text("<svg")
    out, alone = tmp_path / "out", tmp_path / "alone"
    with started(shop, *MANY_TOOLS, "--out", out, "--local-cluster", 2) as command:
        wait_for_records(command, out)
        workers = [
            process
            for process in psutil.Process(command.pid).children(recursive=True)
            if "spawn_main" in " ".join(process.cmdline())
        ]
        assert workers or command.poll() is not None
        workers[0].kill()
        wait_for_records(command, out)
        command.kill()
        command.communicate(timeout=300)
    assert 0 < len(records_in(out)) < 199 * 5
    code, _, warned = run(shop, *MANY_TOOLS, "--out", out, "--local-cluster", 2)
    assert code == 0, warned
    assert run(shop, *MANY_TOOLS, "--out", alone, "--workers", 1)[0] == 0
    assert records_in(out) == records_in(alone) and len(records_in(out)) == 200 + 199 * 4
    for name in ("results.parquet", "best.parquet"):
        assert rows_of(out, name) == rows_of(alone, name)


def test_a_place_to_work_is_one(tmp_path: Path) -> None:
    code, _, warned = run("widget", *TOOLS, "--out", tmp_path / "out", "--workers", 1, "--local-cluster", 1)
    assert code == 2 and "each choose where the work is done: give only one of them" in warned
