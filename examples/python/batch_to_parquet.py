# /// script
# dependencies = ["kinopt[tables]"]
# tool.uv.sources.kinopt = { path = "../../python" }
# ///
"""A hundred thousand poses on all cores, written to a Parquet file."""

import sys
import time

import pyarrow.parquet as pq

import kinopt

out = sys.argv[1] if len(sys.argv) > 1 else "solutions.parquet"
robot = kinopt.models.panda()
arm = kinopt.Arm(robot, "base", "tool")
targets = arm.base_from_tool(robot.random_configuration(1, 100_000)[:, :7])
begun = time.perf_counter()
batch = arm.solve_batch(targets, threads=None)
print(f"{batch.reached.mean():.2%} reached in {time.perf_counter() - begun:.2f} s")
pq.write_table(batch.to_arrow(), out)
print(pq.read_schema(out).names)
