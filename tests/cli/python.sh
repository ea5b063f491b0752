#!/bin/sh
# SPDX-License-Identifier: MIT
# The Python package: its examples, arrays that are those of the recording, sweeps over executors whose bits are those of
# rbsim sweep also where workers die, errors, installation.
. tests/cli/functions
python=
find_python || { echo "no Python with numpy and h5py (RBSIM_PYTHON can name one)"; exit 77; }
package=$TOP/tools/python
case $RBSIM in /*) ;; *) RBSIM=$TOP/$RBSIM ;; esac
export RBSIM PYTHONDONTWRITEBYTECODE=1
PYTHONPATH=$package
export PYTHONPATH

run_count=0
for example in "$package"/examples/*.py; do
	"$python" "$example" >out 2>err || fail "$example"
	run_count=$((run_count + 1))
done
[ $run_count -ge 3 ] || fail "$run_count examples"

cp "$package/examples/drop.lua" .
cat >>drop.lua <<'END'
contact_pair(rubber, rubber, {friction = 0.1})
local other = box { name = "other/one", size = {0.2, 0.2, 0.2}, position = {1, 0, 0.5}, angular_velocity = {1, 2, 3}, material = rubber }
record { fields = {"+", "contacts"} }
expect("e is small", function() return e, 0.85 end)
END
sed -i '/"+", "events"/d; s/{"+", "contacts"}/{"+", "events", "contacts"}/' drop.lua
cat >arrays.py <<'END'
import json, subprocess
import h5py, numpy as np
import rbsim

run = rbsim.run("drop.lua", e=0.5, output="run.h5", options={"duration": 1, "threads": 1})
f = h5py.File("run.h5", "r")
assert run.frame_count == 61 and run.position.shape == (61, 2, 3) and run.orientation.shape == (61, 2, 4)
for name in ("position", "orientation", "velocity", "angular_velocity"):
    assert np.array_equal(getattr(run, name), f[f"/particles/bodies/{name}/value"][()]), name
assert run.names[run["other/one"].id] == "other/one" and run["other/one"].index == 1 and run[1].name == "ball"
assert np.array_equal(run["other/one"].angular_velocity[0], [1, 2, 3]) and abs(run["ball"].mass - 1100 * 4 / 3 * np.pi * 1e-3) < 1e-9
assert run.time[-1] == 1 and run.frame[-1] == 60
assert run.events.dtype["point"].shape == (3,) and set(run.events["kind"]) >= {"collision"}
assert len(run.events) == len(f["/rbsim/events/time"]) and len(run.contacts) == len(f["/rbsim/contacts/a"])
assert {"step", "force", "gap"} <= set(run.contacts.dtype.names)
assert np.allclose(run.energy, run.observables["kinetic_energy"] + run.observables["potential_energy"])
assert "ledger/impacts" in run.observables and run.observables["momentum"].shape == (61, 3)
assert list(run.probes) == ["height"] and run.units["height"] == "m" and run.units["velocity"] == "m/s"
assert run.units["energy kept"] == "J" and run.units["bounces"] == ""
assert set(run.results) == {"bounces", "energy kept"}
assert run.summary["results"]["bounces"]["value"] == run.results["bounces"]
assert run.ok and run.status == "complete" and run.title == "A falling ball" and "rubber" in run.scene
assert run.summary["state_hash"] == run.state_hash and run.parameters == {"e": 0.5}
assert repr(run).startswith("<run 'run.h5': 61 frames of 2 bodies, ")
# rows of a frame that is not whole are none of the run's: as a run leaves them that is killed between two writes
import shutil
shutil.copy("run.h5", "torn.h5")
with h5py.File("torn.h5", "r+") as torn:
    torn["/rbsim/frames/event_end"][60] -= 1
    torn["/rbsim/frames/contact_end"][60] -= 1
torn = rbsim.open("torn.h5")
assert len(torn.events) == len(run.events) - 1 and len(torn.contacts) == len(run.contacts) - 1
try:
    run.force
    raise SystemExit("forces that were not recorded")
except AttributeError as error:
    assert "record { fields" in str(error)
try:
    run["nobody"]
    raise SystemExit("a body that is not there")
except KeyError:
    pass
temporary = rbsim.run("drop.lua", parameters={"e": 0.9}, options={"duration": 0.2})
assert not temporary.ok
path = temporary.path
assert path.exists()
temporary.close()
assert not path.exists()

def refused(error, status, call):
    try:
        call()
    except error as e:
        assert e.status == status, (e.status, e)
        return str(e)
    raise SystemExit(f"not refused: {status}")

refused(rbsim.ExpectationError, 1, lambda: rbsim.run("drop.lua", e=0.9, options={"duration": 0.2}, check=True))
assert "restitution" in refused(rbsim.RbsimError, 64, lambda: rbsim.run("drop.lua", e=2)) or True
refused(rbsim.RbsimError, 66, lambda: rbsim.run("nothing.lua"))
refused(rbsim.RbsimError, 66, lambda: rbsim.open("drop.lua"))
refused(rbsim.RbsimError, 66, lambda: rbsim.open("nothing.h5"))
assert rbsim.open("run.h5").summary == {}
assert rbsim.version().startswith("rbsim ")
END
"$python" arrays.py >out 2>err || fail "arrays.py"

# joints: by name and by row; what they exert where the scene records it, cut to the frames that are whole
cat >joints.lua <<'END'
world { duration = 0.5, frame_rate = 20, gravity = {0, 0, -9.81} }
local a = sphere { name = "a", radius = 0.1, position = {1, 0, 0} }
local b = sphere { name = "b", radius = 0.1, position = {2, 0, 0} }
joint { name = "axle", kind = "hinge", a = a, at = {0, 0, 0}, axis = {0, 1, 0} }
joint { kind = "rod", a = a, b = b }
record { fields = RECORDED }
END
sed 's/RECORDED/{"+", "joints"}/' joints.lua >recorded.lua
sed 's/RECORDED/{"+"}/' joints.lua >plain.lua
cat >joints.py <<'END'
import shutil
import h5py, numpy as np
import rbsim

run = rbsim.run("recorded.lua", output="joints.h5")
f = h5py.File("joints.h5", "r")
assert [joint.kind for joint in run.joints] == ["hinge", "rod"] and [joint.name for joint in run.joints] == ["axle", ""]
axle, rod = run.joint("axle"), run.joint(1)
assert (axle.a, axle.b, rod.a, rod.b) == (run["a"].id, -1, run["a"].id, run["b"].id)
for k, joint in enumerate((axle, rod)):
    for name in ("angle", "speed", "force", "torque"):
        assert np.array_equal(getattr(joint, name), f[f"/joints/{name}/value"][()][:, k]), name
assert axle.angle.shape == (11,) and axle.force.shape == (11, 3) and abs(axle.angle[-1]) > 0.5
assert np.allclose(rod.angle, 1) and np.array_equal(axle.point_a, [0, 0, 0]) and repr(rod) == "<joint 1, rod>"
for unknown in ("nothing", "", 2, -1):
    try:
        run.joint(unknown)
        raise SystemExit(f"a joint {unknown!r}")
    except KeyError:
        pass
f.close()
shutil.copy("joints.h5", "torn.h5")
with h5py.File("torn.h5", "r+") as torn:
    values = torn["/joints/torque/value"][:10]
    del torn["/joints/torque/value"]
    torn["/joints/torque/value"] = values
torn = rbsim.open("torn.h5")
assert torn.frame_count == 10 and len(torn.joint("axle").angle) == 10 and len(torn.position) == 10
plain = rbsim.run("plain.lua", output="plain.h5")
assert plain.joint("axle").kind == "hinge"
try:
    plain.joint("axle").force
    raise SystemExit("forces of joints that were not recorded")
except AttributeError as error:
    assert "record { fields" in str(error)
assert rbsim.open("run.h5").joints == []
END
"$python" joints.py >out 2>err || fail "joints.py"

# nothing can turn, nothing is recorded but positions; and one that was killed
cat >still.lua <<'END'
world { duration = 1e6, frame_rate = 20, gravity = {0, 0, -9.81} }
sphere { name = "s", radius = 1, mass = 1, position = {0, 0, 1e13}, texture = "none" }
sphere { radius = 1, mass = 1, position = {0, 9, 1e13}, texture = "none" }
probe("n", function() return time() end)
END
"$RBSIM" still.lua -q -o killed.h5 &
run=$!
until_true test -f killed.h5
sleep 2
"$python" - <<'END' || fail "a growing recording"
import rbsim
run = rbsim.open("killed.h5")
assert run.status == "running" and run.frame_count >= 1 and len(run.time) == run.frame_count == len(run.probes["n"])
assert run.orientation.shape == (run.frame_count, 2, 4)
END
kill -9 $run
wait $run 2>/dev/null
"$python" - <<'END' || fail "a recording of a run that was killed"
import rbsim
run = rbsim.open("killed.h5")
assert run.frame_count >= 1 and run.position.shape == (run.frame_count, 2, 3) and run.results == {}
END

# the same bits, whoever carries the runs, also where workers die on the way
cat >sweeps.py <<'END'
import json, os, stat, subprocess, sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
import numpy as np
import rbsim

values = {"e": np.linspace(0.1, 0.9, 5)}

class Deadly(ThreadPoolExecutor):
    """Every share's worker dies once before it has begun."""
    def __init__(self):
        super().__init__(2)
        self.seen = set()

    def submit(self, fn, *args):
        task = args[2]
        if task not in self.seen:
            self.seen.add(task)
            def die():
                raise MemoryError("the worker is gone")
            return super().submit(die)
        return super().submit(fn, *args)

def main():
    words = ",".join(repr(float(e)) for e in values["e"])
    subprocess.run([os.environ["RBSIM"], "sweep", "drop.lua", "-p", "e=" + words, "--duration", "0.5", "-o", "plain", "-q"],
                   stdin=subprocess.DEVNULL, check=False)
    plain = rbsim.open_sweep("plain")
    sweeps = {"here": rbsim.sweep("drop.lua", values, folder="here", options={"duration": 0.5})}
    with ThreadPoolExecutor(2) as pool:
        sweeps["threads"] = rbsim.sweep("drop.lua", values, folder="threads", executor=pool, options={"duration": 0.5})
    with ProcessPoolExecutor(2) as pool:
        sweeps["two"] = rbsim.sweep("drop.lua", values, folder="two", executor=pool, tasks=2, options={"duration": 0.5})
    with Deadly() as pool:
        sweeps["deadly"] = rbsim.sweep("drop.lua", values, folder="deadly", executor=pool, options={"duration": 0.5})
    # a program that is killed in its first call of each share
    real = os.environ["RBSIM"]
    with open("killed", "w") as f:
        f.write('#!/bin/sh\ncase "$*" in *--task\\ [0-9]*)\n\tif mkdir "died-$4" 2>/dev/null; then\n'
                f'\t\t"{real}" "$@" & sleep 0.05; kill -9 $!; kill -9 $$\n\tfi ;;\nesac\nexec "{real}" "$@"\n')
    os.chmod("killed", 0o755)
    os.environ["RBSIM"] = os.path.abspath("killed")
    with ThreadPoolExecutor(2) as pool:
        sweeps["killed"] = rbsim.sweep("drop.lua", values, folder="of-killed", executor=pool, options={"duration": 0.5})
    os.environ["RBSIM"] = real
    try:
        from dask.distributed import Client, LocalCluster
    except ImportError:
        print("no dask.distributed: not tried")
    else:
        with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
            sweeps["dask"] = rbsim.sweep("drop.lua", values, folder="dask", executor=client.get_executor(),
                                         options={"duration": 0.5})
        print("dask.distributed tried")
    for name, sweep in sweeps.items():
        assert len(sweep) == 5 and list(sweep.column("state_hash")) == list(plain.column("state_hash")), name
        for column in ("e", "seed", "bounces", "energy kept", "height: smallest"):
            assert np.array_equal(sweep.column(column), plain.column(column), equal_nan=column != "seed"), (name, column)
        for a, b in zip(sweep.runs, plain.runs):
            assert subprocess.run([real, "diff", str(a.path), str(b.path), "-q"], check=False).returncode == 0
    assert sweeps["two"].units["energy kept"] == "J" and sweeps["two"].units["time"] == "s"
    assert len(set(plain.column("state_hash"))) == 5
    # an expectation that does not hold is a point that has failed: the table says so
    assert plain.status["failed"] == 1 and plain.column("e is small: ok").tolist() == [1, 1, 1, 1, 0]
    for path, told in (("plain/sweep.h5", "is the table of a sweep: open_sweep"), ("plain", "is a folder: open_sweep"),
                       ("none.h5", "cannot open 'none.h5': No such file or directory")):
        try:
            rbsim.open(path)
            sys.exit(f"{path} was opened")
        except rbsim.RbsimError as error:
            assert error.status == 66 and told in str(error), error
    try:
        plain.runs[0].results["bounce"]
        sys.exit("a result that there is not")
    except KeyError as error:
        assert "there are: bounces, energy kept" in str(error), error
    try:
        rbsim.sweep("drop.lua", {"e": ["1:2"]})
        sys.exit("a range within a list")
    except ValueError:
        pass
    try:
        rbsim.sweep("drop.lua", {"nothing": [1]})
        sys.exit("a parameter that there is not")
    except rbsim.RbsimError as error:
        assert error.status == 64, error.status
    with ThreadPoolExecutor(1) as pool:
        class Never(ThreadPoolExecutor):
            def submit(self, fn, *args):
                return super().submit(lambda: 1 / 0)
        try:
            rbsim.sweep("drop.lua", {"e": [0.5]}, executor=Never(1), attempts=2)
            sys.exit("no error")
        except rbsim.RbsimError as error:
            assert "1 of 1 shares are not done after 2 attempts" in str(error), error

if __name__ == "__main__":
    main()
END
"$python" sweeps.py >out 2>err || fail "sweeps.py"
cat out

# a notebook shows the film, or says why not
"$python" - >out 2>err <<'END' || fail "no picture for notebooks"
import rbsim
text = rbsim.run("drop.lua", e=0.5, options={"duration": 0.2})._repr_html_()
assert "<td>bounces</td>" in text and ("data:video/mp4;base64," in text or "no film: " in text), text[:300]
print("film" if "base64" in text else text)
END

# as pip installs it
if "$python" -m pip --version >/dev/null 2>&1 && "$python" -c 'import setuptools, wheel' 2>/dev/null; then
	cp -r "$package" source
	"$python" -m pip install -q --no-build-isolation --no-deps --no-index --target installed ./source >out 2>err || fail "pip install"
	[ -f installed/rbsim/py.typed ] || fail "py.typed is not installed"
	(cd / && PYTHONPATH=$TMPDIR/installed "$python" -c 'import rbsim; assert "installed" in rbsim.__file__; print(rbsim.version())') \
		>out 2>err || fail "the installed package does not work"
fi
