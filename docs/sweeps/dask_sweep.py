"""Computes the shards of a sweep on a Dask cluster and puts them together.

    python dask_sweep.py SWEEP.json -o table.csv --shards 16 [--scheduler tcp://host:8786] [--standstill PATH]

Without a scheduler a cluster of this machine's processors is started. Every worker needs the program and the files of
the sweep under the same paths, and `table.csv` on a disk that all of them share.
"""

import argparse
import subprocess
import sys

from dask.distributed import Client, LocalCluster


def shard(program, sweep, table, part, shards):
    """Computes one shard; the path of its table."""
    path = f"{table}.{part}-of-{shards}.csv"
    # One thread: the cluster runs as many shards at once as it has processors.
    command = [program, "sweep", sweep, "--shard", f"{part}/{shards}", "--threads", "1", "-o", path]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    # 1 and 3 are verdicts of cases; both leave a table.
    if ended.returncode not in (0, 1, 3):
        raise RuntimeError(f"shard {part}/{shards} ended with {ended.returncode}: {ended.stderr}")
    return path


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sweep")
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--shards", type=int, default=16)
    parser.add_argument("--scheduler")
    parser.add_argument("--standstill", default="standstill")
    wish = parser.parse_args()

    cluster = wish.scheduler or LocalCluster(threads_per_worker=1, dashboard_address=None)
    with Client(cluster) as client:
        parts = range(1, wish.shards + 1)
        futures = [client.submit(shard, wish.standstill, wish.sweep, wish.output, part, wish.shards) for part in parts]
        tables = client.gather(futures)
    merge = [wish.standstill, "sweep", wish.sweep, "-o", wish.output, "--merge", *tables]
    return subprocess.run(merge, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
