"""A run tick by tick."""
import os
from types import MappingProxyType

import numpy as np

from . import _argil
from .errors import InputError


def _numbers(name, values, count):
    if values is None:
        return None
    array = np.asarray(values, dtype=float)
    if array.shape != (count,):
        raise InputError(f"{name}: has the shape {array.shape}; give {count} numbers")
    return array.tolist()


class Simulation:
    """A body and a tool between two ticks; Scenario.start makes it.

    `tick()` goes along the scenario's motion, with the bits of `argil run`. `tick(position)` is a hand of one's own.
    The first tick decides which of the two it is.

    Arrays are of the moment at which they are asked for: a later tick does not change them, and they are read-only.
    They hold one entity a row in the order of the result file, SI units. Those of the body are copies of it as it is,
    made once a tick when the first of them is asked for; to read one again copies nothing.

    As a context manager, or with close(), the record ends well. One thread at a time may use a simulation; while a tick
    is made others go on. It is not to be used in a forked process.
    """

    def __init__(self, scene, *, threads=1, record=None, position=None, orientation=None, mode=None):
        if position is None and (orientation is not None or mode is not None):
            raise InputError("the hand's start: has no position; give it, too")
        self._run = _argil.Simulation(scene._loaded, threads, os.fspath(record or ""),
                                      _numbers("position", position, 3), _numbers("orientation", orientation, 4), mode)

    def tick(self, position=None, orientation=None, mode=None):
        """One haptic tick; returns the force on the hand [N], 3.

        Without arguments the tool follows the scenario's motion (and its simulated hand, if it has one). Else position
        [m], orientation (unit quaternion x, y, z, w, tool to world) and mode ("push", "pull", "wet", "dry") are where
        the hand is when the tick ends; what is left out stays as it was.

        Raises RunFailed, after which all is as before the tick; InputError for what is no pose and past the motion's
        end.
        """
        if position is None:
            if orientation is not None or mode is not None:
                raise InputError("tick: has an orientation or a mode, but no position; give it, too")
            self._run.tick()
        else:
            self._run.tick_at(_numbers("position", position, 3), _numbers("orientation", orientation, 4), mode)
        return self._run.force

    def run(self, ticks=None, hand=None):
        """Makes `ticks` ticks, without a number all that are left of the scenario's motion.

        hand: called before each as hand(time, force) with the time [s] at the tick's end and the force that the device
        renders meanwhile [N]; returns what tick() takes: a position, or a tuple of position, orientation and mode. What
        it raises ends the loop. Without it the tool follows the scenario's motion.
        """
        for _ in range(max(0, self.num_ticks - self.ticks) if ticks is None else ticks):
            if hand is None:
                self._run.tick()
                continue
            place = hand((self.ticks + 1) * self.period, self.device_force)
            if place is None:
                raise InputError("run: the hand returned None; return a position, or a tuple of position, orientation and mode")
            if isinstance(place, tuple) and np.ndim(place[0]) == 1:
                self.tick(*place)
            else:
                self.tick(place)

    def close(self):
        """Ends the record: as `argil run` after the last tick of the scenario's motion; as an interrupted one before
        it. A run with a hand of one's own is done when it is closed."""
        self._run.finish(False)

    def __enter__(self):
        return self

    def __exit__(self, kind, error, trace):
        self._run.finish(kind is not None)

    ticks = property(lambda self: self._run.ticks, doc="Ticks that have been made.")
    num_ticks = property(lambda self: self._run.num_ticks, doc="Ticks of the scenario's motion.")
    period = property(lambda self: self._run.period, doc="Length of a tick [s].")
    time = property(lambda self: self._run.time, doc="Since the start [s].")
    force = property(lambda self: self._run.force, doc="On the hand [N], 3, before passivity and gate.")
    torque = property(lambda self: self._run.torque, doc="On the hand about its point [N m], 3, likewise.")
    force_error = property(lambda self: self._run.force_error,
                           doc="Estimate [N] of by how much the force is off; 0 without /haptics/force_error.")
    force_error_parts = property(lambda self: self._run.force_error_parts,
                                 doc="Its parts [N]: mesh, step, contact, solver, left_out.")
    device_force = property(lambda self: self._run.device_force, doc="As the device renders it [N], 3, after the gate.")
    tool_position = property(lambda self: self._run.tool_position, doc="Hand's point [m], 3.")
    tool_orientation = property(lambda self: self._run.tool_orientation,
                                doc="Unit quaternion x, y, z, w, tool to world.")
    mode = property(lambda self: self._run.mode, doc='"push", "pull", "wet" or "dry".')
    num_contacts = property(lambda self: self._run.num_contacts, doc="Contacts that made the force.")
    positions = property(lambda self: self._run.positions, doc="Of the cage's vertices [m], n×3.")
    saturation = property(lambda self: self._run.saturation, doc="Of each tet [–], 0 to 1.")
    plastic_strain = property(lambda self: self._run.plastic_strain,
                              doc="Of each tet [–], m×6, Mandel: 11 22 33 √2·23 √2·13 √2·12.")
    skin_positions = property(lambda self: self._run.skin_positions,
                              doc="Of the skin's vertices [m], k×3; 0×3 without a skin.")
    skin_saturation = property(lambda self: self._run.skin_saturation, doc="At the skin's vertices [–].")
    physics = property(lambda self: self._run.physics(),
                       doc="Energies [J], water [kg] and the solver's numbers of the last physics step, a dict with "
                           "the names of /physics in a result.")
    notes = property(lambda self: self._run.notes(), doc="What there is to know of the scene, a list of texts.")
    state_hash = property(lambda self: self._run.state_hash(),
                          doc="SHA-256 of all that a tick takes from earlier ones: where equal, equal bits follow.")

    _mesh, _mesh_epoch = None, None
    epoch = property(lambda self: self._run.epoch, doc="How often the body has got new cells.")

    @property
    def mesh(self):
        """The cells that the body has now, which ticks change where it gets new ones (epoch), and what no tick changes,
        by the names of /mesh in a result: rest_position n×3 [m], tets m×4, surface_triangles
        and skin_triangles ·×3 (vertex numbers from 0, outward), tool_vertices [m] and tool_triangles (tool's frame)."""
        if self._mesh_epoch != self.epoch:
            self._mesh, self._mesh_epoch = MappingProxyType(self._run.mesh()), self.epoch
        return self._mesh

    @property
    def tets(self):
        """Vertex numbers of the tets, m×4."""
        return self.mesh["tets"]

    @property
    def surface(self):
        """Triangles of the body's boundary, vertex numbers, outward."""
        return self.mesh["surface_triangles"]

    @property
    def skin(self):
        """Triangles of the skin, numbers of its vertices, outward; 0×3 without one."""
        return self.mesh["skin_triangles"]

    def __repr__(self):
        return f"<argil.Simulation after {self.ticks} ticks: {len(self.tets)} tets, force {self.force} N>"
