#!/usr/bin/env python3
"""Runs a program in LinuxCNC and records the pins of its step generators: scripts/inline-linuxcnc makes this its [DISPLAY]."""
import os
import subprocess
import sys
import time

import linuxcnc

HERE = os.path.dirname(os.path.abspath(__file__))
command, status, errors = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()


def until(holds, what):
    end = time.monotonic() + 60
    while True:
        status.poll()
        while message := errors.poll():
            print("said:", message[1].strip(), flush=True)
        if holds():
            return
        if time.monotonic() > end:
            print("NOT", what, flush=True)
            sys.exit(1)
        time.sleep(0.005)


def idle():
    return status.interp_state == linuxcnc.INTERP_IDLE and status.inpos and status.queue == 0


status.poll()
command.state(linuxcnc.STATE_ESTOP_RESET)
command.wait_complete()
command.state(linuxcnc.STATE_ON)
until(lambda: status.task_state == linuxcnc.STATE_ON, "the machine is on")
command.mode(linuxcnc.MODE_MANUAL)
command.wait_complete()
command.home(-1)
until(lambda: all(status.homed[:3]), "all axes are homed")
recorder = subprocess.Popen(["halsampler", "-t", os.path.join(HERE, "pins.txt")])
time.sleep(0.5)
subprocess.run(["halcmd", "setp", "sampler.0.enable", "1"], check=True)
command.mode(linuxcnc.MODE_AUTO)
command.wait_complete()
command.program_open(os.path.join(HERE, "inline.ngc"))
command.auto(linuxcnc.AUTO_RUN, 0)
until(lambda: status.interp_state != linuxcnc.INTERP_IDLE, "the program begins")
until(idle, "the program ends")
time.sleep(0.5)
subprocess.run(["halcmd", "setp", "sampler.0.enable", "0"], check=True)
time.sleep(0.5)
recorder.terminate()
overruns = subprocess.run(["halcmd", "getp", "sampler.0.overruns"], capture_output=True, text=True).stdout.strip()
print("overruns", overruns, flush=True)
print("done", flush=True)
