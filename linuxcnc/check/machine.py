#!/usr/bin/env python3
"""What LinuxCNC does with a posicast stage: scripts/linuxcnc makes this its [DISPLAY].

It homes the axes, runs a program with the machine's shapers and without, and then pulls one thing after the other out. With `steps` it does
so with the machine of steps.toml, which is homed by probes and has a touch probe. Every line that it prints is a check that held, or a figure; it ends with
`done`, or with what did not hold.
"""
import json
import os
import socket
import subprocess
import sys
import time

import linuxcnc

HERE = os.path.dirname(os.path.abspath(__file__))
PROGRAM = os.path.join(HERE, "part.ngc")
EMERGENCY_STOP, WATCHDOG = 1 << 0, 1 << 13
FOLLOWING_ERROR, DEVIATION, ENCODER = 1 << 7, 1 << 8, 1 << 10 | 1 << 11
CLOCK_HZ = 50e6
STEPS = "steps" in sys.argv
# Two counts of the encoder, or two steps.
REST_MM = 0.005 if STEPS else 0.002
STEP_M = 1e-3 / 400
# Counts from the start to the indices, or to the contacts of the probes of steps.toml, 3 mm away.
ORIGINS = [-1200, 1200] if STEPS else [777, 777]
PATIENCE_S = float(os.environ.get("POSICAST_PATIENCE_S", "120"))

command, status, errors = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()
said = []


class Stage:
    """The control socket of the simulated stage."""

    def __init__(self, folder):
        link = socket.socket(socket.AF_UNIX)
        link.connect(os.path.join(folder, "control"))
        self.lines = link.makefile("rw")

    def __call__(self, line):
        print(line, file=self.lines, flush=True)
        answer = json.loads(self.lines.readline())
        require("error" not in answer, f"the stage takes `{line}`: {answer}")
        return answer

    def quit(self):
        print("quit", file=self.lines, flush=True)


def require(holds, what):
    if not holds:
        print("NOT", what, "|", said[-5:], flush=True)
        sys.exit(1)


def check(holds, what):
    require(holds, what)
    print("ok", what, flush=True)


def poll():
    status.poll()
    while message := errors.poll():
        said.append(message[1].strip())


def until(holds, what):
    end = time.monotonic() + PATIENCE_S
    # What was polled before the command that is waited for says nothing.
    poll()
    while not holds():
        require(time.monotonic() < end, what)
        time.sleep(0.005)
        poll()


def pin(name, value=None):
    words = ["getp", name] if value is None else ["setp", name, str(value)]
    return subprocess.run(["halcmd", *words], check=True, capture_output=True, text=True).stdout.strip()


def shapers(on):
    for axis in (0, 1):
        pin(f"posicast.{axis}.unshaped", int(not on))


def mode(wanted):
    command.mode(wanted)
    command.wait_complete(PATIENCE_S)


def switch_on():
    poll()
    command.state(linuxcnc.STATE_ESTOP_RESET)
    command.wait_complete(PATIENCE_S)
    command.state(linuxcnc.STATE_ON)
    until(lambda: status.task_state == linuxcnc.STATE_ON, "the machine is on")
    until(lambda: int(pin("posicast.phase")) == 3, "the stage follows")


def home():
    mode(linuxcnc.MODE_MANUAL)
    command.teleop_enable(0)
    command.wait_complete(PATIENCE_S)
    command.unhome(-1)
    until(lambda: not any(status.homed[:2]), "no axis is homed")
    command.home(-1)
    until(lambda: all(status.homed[:2]), "all axes are homed")
    until(idle, "the axes rest")


def idle():
    """The program is over, and the machine has followed it: what shaper and FIFO delay comes after LinuxCNC's command."""
    is_there = all(abs(joint["ferror_current"]) < REST_MM for joint in status.joint[:2])
    return status.interp_state == linuxcnc.INTERP_IDLE and status.inpos and status.queue == 0 and is_there


def move(line, wait=True):
    mode(linuxcnc.MODE_MDI)
    command.mdi(line)
    if wait:
        command.wait_complete(PATIENCE_S)
        until(idle, f"{line} ends")


def start_program():
    mode(linuxcnc.MODE_AUTO)
    command.program_open(PROGRAM)
    command.auto(linuxcnc.AUTO_RUN, 0)
    until(lambda: status.interp_state != linuxcnc.INTERP_IDLE, "the program begins")


def program(stage, name):
    stage("record")
    began, since = stage("state")["clocks"], time.monotonic()
    start_program()
    until(idle, "the program ends")
    took = time.monotonic() - since
    passed = (stage("state")["clocks"] - began) / CLOCK_HZ
    print(f"figure {passed:.2f} s of the machine in {took:.2f} s, {name}", flush=True)
    figures = stage(f"path {name} {PROGRAM}")
    print("path", json.dumps(figures), flush=True)
    rest = [abs(value) for value in status.actual_position[:2]]
    check(max(rest) <= REST_MM, f"the program {name} ends where it began, within two counts: {max(rest) * 1e3:.0f} um")
    return figures


def lag():
    """Seconds from LinuxCNC's command to the encoder, from the following error at constant speed."""
    move("G1 F3000 X-20", wait=False)
    most = 0.0
    until(lambda: status.current_vel > 0, "the move begins")
    while not idle():
        poll()
        most = max(most, abs(status.joint[0]["ferror_current"]))
    move("G0 X0")
    return most / 50.0


def off(stage, cause, what):
    """All outputs off, and the cause in one axis at least."""
    axes = stage("state")["axes"]
    check(not any(axis["outputs_on"] for axis in axes), f"{what}: the outputs are off")
    check(any(axis["causes"] & cause for axis in axes), f"{what}: the stage has the cause {[hex(a['causes']) for a in axes]}")


def shown(text, what):
    until(lambda: any(text in line for line in said), f"LinuxCNC shows `{text}`: {said[-5:]}")
    print("ok", f"{what}: LinuxCNC shows `{[line for line in said if text in line][-1]}`", flush=True)
    said.clear()


def emergency_stop(stage):
    start_program()
    time.sleep(0.5)
    stage("set emergency_stop_n 0")
    until(lambda: status.task_state == linuxcnc.STATE_ESTOP, "LinuxCNC is in estop")
    off(stage, EMERGENCY_STOP, "emergency stop")
    shown("emergency stop", "emergency stop")
    stage("set emergency_stop_n 1")
    switch_on()
    check(True, "emergency stop: the machine goes on again")


def switched_off(stage):
    until(lambda: status.task_state != linuxcnc.STATE_ON, "LinuxCNC switches off")
    until(lambda: not any(axis["outputs_on"] for axis in stage("state")["axes"]), "the outputs go off")


def encoder_fault(stage):
    # On that side of the index where homing begins: it is at 0.
    move("G0 X-1 Y-1")
    move("G1 F600 X-6", wait=False)
    until(lambda: status.current_vel > 5, "the move begins")
    stage("stick x")
    switched_off(stage)
    off(stage, FOLLOWING_ERROR | ENCODER, "encoder fault")
    shown("posicast: axis x", "encoder fault")
    stage("mend x")
    switch_on()
    home()
    check(True, "encoder fault: the machine is homed again")


def standing(stage):
    """Position of x once it stands, in m: LinuxCNC calls a move done while shaper and load are still within its tolerance."""

    def place():
        return stage("state")["axes"][0]["position"]

    def stands():
        before = place()
        time.sleep(0.2)
        return abs(place() - before) < STEP_M / 25

    until(stands, "x stands")
    return place()


def stall(stage):
    # Near both contacts: homing approaches them slowly.
    move("G0 X1 Y57")
    before = standing(stage)
    move("G1 F3000 X10", wait=False)
    until(lambda: status.current_vel > 5, "the move begins")
    stage("jam x")
    switched_off(stage)
    off(stage, DEVIATION, "stall")
    shown("posicast: axis x: deviation", "stall")
    stage("free x")
    switch_on()
    home()
    move("G0 X1 Y57")
    after = standing(stage)
    # Each of the two homings is true to a step.
    check(abs(after - before) <= 2 * STEP_M, f"stall: homed again, x is where it was: {(after - before) * 1e6:.1f} um")


def touch_probe(stage):
    """G38.2 with a touch on the way, which the test makes, and without one."""

    def place():
        return float(pin("posicast.0.pos-fb"))

    move("G0 X1 Y57")
    edges = int(pin("posicast.probe-edges"))
    move("G38.2 F300 X20", wait=False)
    until(lambda: status.current_vel > 4, "the probing move begins")
    before = place()
    stage("set capture_line 1")
    until(lambda: int(pin("posicast.probe-edges")) == edges + 1, "the touch is seen")
    after = place()
    command.wait_complete(PATIENCE_S)
    until(idle, "the probing move ends")
    probed, stands = float(pin("posicast.0.probed")), place()
    check(before <= probed <= after, f"touch probe: the hardware's position is on the way: {before:.4f} <= {probed:.4f} <= {after:.4f} mm")
    check(status.probe_tripped and probed < stands < probed + 0.5, f"touch probe: LinuxCNC stops {stands - probed:.4f} mm behind it")
    stage("set capture_line 0")
    until(lambda: pin("posicast.probe-input") == "FALSE", "the probe is free")
    said.clear()
    move("G38.2 F600 X8", wait=False)
    shown("without making contact", "touch probe")


def servo_thread_stops(stage):
    move("G0 X0 Y0")
    start_program()
    time.sleep(0.5)
    subprocess.run(["halcmd", "stop"], check=True)
    time.sleep(2.5)
    off(stage, WATCHDOG, "servo thread stopped")
    subprocess.run(["halcmd", "start"], check=True)
    shown("watchdog", "servo thread stopped")
    switch_on()
    check(True, "servo thread stopped: the machine goes on again")


def link_breaks(stage):
    move("G0 X0 Y0")
    start_program()
    time.sleep(0.5)
    axes = stage("drop")["axes"]
    check(not any(axis["outputs_on"] for axis in axes), "link pulled: the stage switches its outputs off by itself")
    check(all(axis["causes"] & WATCHDOG for axis in axes), "link pulled: the cause is the watchdog")
    until(lambda: status.task_state == linuxcnc.STATE_ESTOP, "LinuxCNC is in estop")
    shown("link to the stage is broken", "link pulled")


def main():
    folder = os.environ["POSICAST_STAGE"]
    stage = Stage(folder)
    time.sleep(0.5)
    switch_on()
    home()
    origins = [axis["origin"] for axis in stage("state")["axes"]]
    exact = all(abs(is_at - should) <= STEPS for is_at, should in zip(origins, ORIGINS))
    contact = "contact, within a step" if STEPS else "index, to the count"
    check(exact, f"homing sets the origin at the {contact}: {origins}")
    move("G0 X0 Y0")
    shaped = program(stage, "shaped")
    if "program" in sys.argv:
        check(stage("state")["mismatches"] == 0, "the Verilog equals the model in every clock")
    elif STEPS:
        machine_with_steps(stage, shaped)
    else:
        machine_with_encoders(stage, shaped, folder)
    stage.quit()
    print("done", flush=True)


def program_unshaped(stage, shaped):
    unshaped = program(stage, "unshaped")
    check(shaped["peak_um"] < unshaped["peak_um"], "the load is nearer to the path with shapers than without")


def machine_with_steps(stage, shaped):
    shapers(False)
    program_unshaped(stage, shaped)
    shapers(True)
    said.clear()
    emergency_stop(stage)
    stall(stage)
    touch_probe(stage)
    link_breaks(stage)


def machine_with_encoders(stage, shaped, folder):
    print("figure accesses of the bus per servo period, two axes:", int(pin("posicast.accesses")), flush=True)
    lags = {"shaped": lag()}
    shapers(False)
    lags["unshaped"] = lag()
    print("figure lag from LinuxCNC's command to the encoder, s:", json.dumps(lags), flush=True)
    program_unshaped(stage, shaped)
    move("G1 F6000 X40", wait=False)
    time.sleep(0.1)
    shapers(True)
    until(idle, "a move during which the tables change ends")
    check(status.task_state == linuxcnc.STATE_ON, "tables change while the axes move")
    move("G0 X0 Y0")
    stage(f"picture {folder}/path.svg")
    for drift in (300, -300):
        stage(f"drift {drift}")
        before = int(pin("posicast.late-ticks"))
        move("G1 F6000 X60 Y10")
        move("G1 F6000 X-60 Y-10")
        move("G0 X0 Y0")
        late = int(pin("posicast.late-ticks")) - before
        check(status.task_state == linuxcnc.STATE_ON and late == 0, f"clocks that differ by {drift} ppm: no point is late")
    stage("drift 0")
    said.clear()
    emergency_stop(stage)
    encoder_fault(stage)
    servo_thread_stops(stage)
    link_breaks(stage)


main()
