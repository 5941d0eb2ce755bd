# SPDX-License-Identifier: MIT
# test: cost=3 full=20 needs=TANDEM_BUILDS_PYTHON
"""Signals during a run, threads, and colliders after fork."""

import os
import signal
import subprocess
import sys
import threading

from tests.collider.case import DEVICES, FOLDER, ColliderCase, tandem

FORK = """
import os, signal, sys
import tandem
corner = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]], [[0, 1, 2, 3]]
device = sys.argv[1]
collider = tandem.Collider([corner, corner], device=device)
answer = collider.run()
for name, use in (("run", collider.run), ("pairs", answer.pairs), ("new", lambda: tandem.Collider([corner], device=device).run()), ("host", tandem.Collider([corner] * 2).run),
                  ("devices", tandem.devices), ("repr", lambda: repr(collider))):
    sys.stdout.flush()
    child = os.fork()
    if child == 0:
        signal.alarm(60)  # ends a child that hangs
        try:
            use()
            print(name, "ok")
        except tandem.DeviceError as error:
            print(name, error)
        sys.exit(0)  # with the destructors of all objects
    print(name, "status", os.waitpid(child, 0)[1])
print("parent", collider.count(), len(answer.pairs()))
"""


class Signals(ColliderCase):
    """The thread that sends signals, and the work that doubles, make no demand on the speed of the machine."""

    many = {
        "algorithm": "gproximity",
        "groups": 8,
        "local_queue": 4,
        "initial_items": 1,
        "idle_limit": 1,
        "output": "digest",
        "contact_rule": "none",
    }

    def ends(self, collider, call):
        """Whether a signal's handler ran within call(), and its exception ended the call."""
        handled, done = [], threading.Event()

        def handler(number, stack):
            if handled:
                return
            try:
                collider.reset()
            except ValueError as error:
                handled.append(str(error))
                signal.default_int_handler(number, stack)

        def send():
            while not done.wait(0.01):
                os.kill(os.getpid(), signal.SIGINT)

        before = signal.signal(signal.SIGINT, handler)
        sender = threading.Thread(target=send)
        sender.start()
        try:
            call()
        except KeyboardInterrupt:
            self.assertIn("the collider is in a run that this signal interrupts", handled[0])
            return True
        finally:
            done.set()
            sender.join()
            signal.signal(signal.SIGINT, before)
        self.assertEqual(handled, [])
        return False

    def test_end_a_run_before_its_next_launch(self):
        pairs = [(a, b) for b in range(512) for a in range(b)]
        for device in DEVICES:
            collider = self.collider(bodies=[0] * 512, device=device, **self.many)
            few = collider.run(body_pairs=pairs[:1])
            for call in (collider.run, collider.update):
                with self.subTest(device=device, call=call.__name__):
                    counts = (2**i for i in range(6, 18))
                    self.assertTrue(
                        any(self.ends(collider, lambda: call(body_pairs=pairs[:count])) for count in counts)
                    )
                    self.assertEqual(
                        collider.run(body_pairs=pairs[:1]).digest(), few.digest(), "usable afterwards"
                    )

    def test_end_tune(self):
        """Of many bodies in one place, so that it takes longer than the 100 ms between two looks at signals."""
        collider = tandem.Collider(self.meshes, algorithm="auto", bodies=[0] * 40)
        self.assertTrue(any(self.ends(collider, lambda: collider.tune(seconds=2.0**i)) for i in range(-3, 4)))
        self.assertEqual(
            collider.run().digest(),
            tandem.Collider(self.meshes, collider.algorithm, bodies=[0] * 40, **collider.settings)
            .run()
            .digest(),
        )

    def test_answers_end_while_another_thread_runs(self):
        """A run waits for the interpreter's lock, which the thread has in which an answer ends."""
        pairs = [(a, b) for b in range(512) for a in range(b)]
        collider = self.collider(bodies=[0] * 512, **self.many)
        for count in (2**i for i in range(6, 15)):
            answers = [collider.run(body_pairs=pairs[:1]) for _ in range(3)]
            runner = threading.Thread(target=collider.run, kwargs={"body_pairs": pairs[:count]})
            runner.start()
            answers.clear()
            runner.join()


class Fork(ColliderCase):
    def test_children_get_an_exception(self):
        for device in DEVICES:
            with self.subTest(device=device):
                done = subprocess.run(
                    [sys.executable, "-c", FORK, device],
                    capture_output=True,
                    text=True,
                    env={**os.environ, "PYTHONPATH": FOLDER.name},
                )
                self.assertEqual(done.returncode, 0, done.stderr)
                lines = done.stdout.splitlines()
                self.assertEqual(
                    [line for line in lines if " status " in line],
                    [f"{name} status 0" for name in ("run", "pairs", "new", "host", "devices", "repr")],
                    done.stdout,
                )
                self.assertEqual(lines[-1].split()[::2], ["parent", "1"], done.stdout)
                refused = [
                    line.split()[0]
                    for line in lines
                    if "this process was forked after its parent had opened OpenCL or CUDA" in line
                ]
                self.assertEqual(refused, [] if device == "host" else ["run", "pairs", "new", "devices"])
                self.assertLessEqual({"host ok", "repr ok"}, set(lines))
