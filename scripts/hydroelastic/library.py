# SPDX-License-Identifier: MIT
"""Drake's side: two compliant meshes in a scene graph. Runs in the environment of `scripts/drake setup`."""

import time

import numpy
from pydrake.geometry import (
    AddCompliantHydroelasticProperties,
    FramePoseVector,
    GeometryFrame,
    GeometryInstance,
    HydroelasticContactRepresentation,
    Mesh,
    ProximityProperties,
    SceneGraph,
)
from pydrake.math import RigidTransform, RotationMatrix

from hydroelastic.polygons import Polygons, rotation


class Library:
    """Bodies A and B. `files`: their meshes, .vtk."""

    def __init__(self, files, modulus):
        self._graph = SceneGraph()
        source = self._graph.RegisterSource("bodies")
        self._frames, self._geometries = [], []
        for name, file in zip("AB", files):
            frame = self._graph.RegisterFrame(source, GeometryFrame(name))
            instance = GeometryInstance(RigidTransform(), Mesh(str(file)), name)
            properties = ProximityProperties()
            AddCompliantHydroelasticProperties(1.0, modulus, properties)
            instance.set_proximity_properties(properties)
            self._frames.append(frame)
            self._geometries.append(self._graph.RegisterGeometry(source, frame, instance))
        self._context = self._graph.CreateDefaultContext()
        self._port = self._graph.get_source_pose_port(source)

    def _query(self, poses):
        moved = FramePoseVector()
        for frame, pose in zip(self._frames, poses):
            moved.set_value(frame, RigidTransform(RotationMatrix(rotation(pose)), pose[:3]))
        self._port.FixValue(self._context, moved)
        return self._graph.get_query_output_port().Eval(self._context)

    def seconds(self, poses):
        """(seconds of ComputeContactSurfaces at poses of A and B, number of polygons)."""
        query = self._query(poses)
        begin = time.perf_counter()
        surfaces = query.ComputeContactSurfaces(HydroelasticContactRepresentation.kPolygon)
        seconds = time.perf_counter() - begin
        return seconds, sum(surface.num_faces() for surface in surfaces)

    def polygons(self, poses, cells):
        """The polygons at poses of A and B. `cells`: those of both, because Drake does not tell its tetrahedra."""
        surfaces = self._query(poses).ComputeContactSurfaces(HydroelasticContactRepresentation.kPolygon)
        if not surfaces:
            return Polygons(numpy.empty((0, 2), "i8"), *(numpy.empty((0, 3)),) * 2, *(numpy.empty(0),) * 2)
        (surface,) = surfaces
        first = int(surface.id_M() != self._geometries[0])  # the body into which normals point
        count = range(surface.num_faces())
        field = surface.poly_e_MN()
        centroid = numpy.array([surface.centroid(i) for i in count])
        gradients = [
            numpy.array([surface.EvaluateGradE_M_W(i) for i in count]),
            numpy.array([surface.EvaluateGradE_N_W(i) for i in count]),
        ]
        if first == 1:
            gradients.reverse()
        pair = [cell.of(centroid, gradient, pose) for cell, gradient, pose in zip(cells, gradients, poses)]
        return Polygons(
            numpy.column_stack(pair),
            centroid,
            numpy.array([surface.face_normal(i) for i in count]) * (-1 if first == 1 else 1),
            numpy.array([surface.area(i) for i in count]),
            numpy.array([field.EvaluateCartesian(i, centroid[i]) for i in count]),
        )
