"""The nominal chain as a discrete-event model in SimPy, the general tool for such things.

Written as one would there: a process for each part of the rig, events and stores between them,
and a PLC that looks at its input in every scan of a measuring move. It plays what the C simulation
plays, without the firmware: approach, touch, stop, return, and the report on its way.
"""

import math
import random
from collections.abc import Generator
from typing import cast

import simpy

from skiplatch.campaign import InputPath, Nominal, Touches
from skiplatch.motion import expected_contact

US_PER_S = 1e6
UM_PER_MM = 1e3

Process = Generator[simpy.Event, object, None]


class Rig:
    """One rig; results of its touches are appended to the lists."""

    def __init__(self, nominal: Nominal, seed: int) -> None:
        self.env = simpy.Environment()
        self.nominal = nominal
        self.random = random.Random(seed)
        self.phase_us = self.random.uniform(0.0, nominal.plc.scan_us)
        self.accel_um_us2 = nominal.axis.accel_mm_s2 * UM_PER_MM / US_PER_S**2
        self.is_deflected = False
        self.edge = self.env.event()
        self.latched = self.env.event()
        self.bus = simpy.Store(self.env)
        self.arrived = simpy.Store(self.env)
        self.latch_us: list[float] = []
        self.report_us: list[float] = []
        self.deviation_um: list[float] = []
        self.env.process(self.bus_process())
        self.env.process(self.recorder_process())

    def pretravel_um(self, alpha_deg: float, beta_deg: float) -> float:
        """Of one touch in this direction."""
        probe = self.nominal.probe
        azimuth = math.radians(3.0 * (alpha_deg - probe.lobe_phase_deg))
        lobe = probe.lobe_um * math.cos(math.radians(beta_deg)) * math.cos(azimuth)
        noise = self.random.gauss(0.0, probe.repeatability_um)
        return max(0.0, probe.pretravel_um + lobe + noise)

    def line_process(self, contact_us: float, travel_us: float) -> Process:
        """Contact, trigger, filter, pin."""
        env = self.env
        yield env.timeout(contact_us - env.now)
        yield env.timeout(travel_us + self.nominal.probe.delay_us)
        yield env.timeout(self.nominal.input.filter_us)
        self.is_deflected = True
        self.edge.succeed()

    def skip_process(self) -> Process:
        """The edge interrupt."""
        yield self.edge
        skip = self.nominal.skip
        yield self.env.timeout(skip.latency_us + self.random.uniform(0.0, skip.jitter_us))
        self.latched.succeed()

    def plc_process(self) -> Process:
        """The scans."""
        env, period_us = self.env, self.nominal.plc.scan_us
        yield env.timeout(-(env.now - self.phase_us) % period_us)
        while not self.is_deflected:
            yield env.timeout(period_us)
        self.latched.succeed()

    def bus_process(self) -> Process:
        """Frames on their way."""
        report = self.nominal.report
        while True:
            frame = yield self.bus.get()
            jitter_us = self.random.uniform(0.0, report.jitter_us)
            yield self.env.timeout(report.latency_us + jitter_us)
            yield self.arrived.put(frame)

    def recorder_process(self) -> Process:
        """The other end of the bus."""
        while True:
            frame = cast(tuple[float, float], (yield self.arrived.get()))
            self.latch_us.append(frame[0])
            self.deviation_um.append(frame[1])
            self.report_us.append(self.env.now)

    def cycle_process(
        self,
        start_us: float,
        contact_us: float,
        speed_um_us: float,
        path: int,
        travel_um: float,
        approach_um: float,
    ) -> Process:
        """One touch: approach, latch, report, stop, return."""
        env, nominal = self.env, self.nominal
        yield env.timeout(start_us - env.now)
        self.is_deflected = False
        self.edge, self.latched = env.event(), env.event()
        env.process(self.line_process(contact_us, travel_um / speed_um_us))
        env.process(self.skip_process() if path == InputPath.SKIP else self.plc_process())
        yield self.latched
        tick, resolution = nominal.skip.tick_us, nominal.axis.resolution_um
        latch_us = math.floor(env.now / tick) * tick
        passed_um = speed_um_us * (env.now - contact_us)
        yield self.bus.put((latch_us, round(passed_um / resolution) * resolution))
        yield env.timeout(speed_um_us / self.accel_um_us2)
        stop_um = speed_um_us**2 / (2.0 * self.accel_um_us2)
        way_um = approach_um + passed_um + stop_um
        yield env.timeout(way_um / speed_um_us + speed_um_us / self.accel_um_us2)

    def campaign_process(self, touches: Touches) -> Process:
        """All touches, which have to be in order of time and far enough apart."""
        contact = expected_contact(self.nominal, touches)
        for row in zip(
            (touches.time_s * US_PER_S).tolist(),
            contact.time_us.tolist(),
            (contact.speed_mm_s * UM_PER_MM / US_PER_S).tolist(),
            touches.path.tolist(),
            map(self.pretravel_um, touches.alpha_deg.tolist(), touches.beta_deg.tolist()),
            (touches.approach_mm * UM_PER_MM).tolist(),
            strict=True,
        ):
            yield self.env.process(self.cycle_process(*row))


def play(nominal: Nominal, touches: Touches, seed: int) -> Rig:
    """Play the touches and return the rig with its results."""
    rig = Rig(nominal, seed)
    rig.env.run(rig.env.process(rig.campaign_process(touches)))
    return rig
