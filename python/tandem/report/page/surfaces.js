// SPDX-License-Identifier: MIT
// Contact surfaces of a scene: polygons coloured by pressure inside translucent bodies, and the legend of these colours.
"use strict";

tandem.translucent = 0.2;

/** The scale of pressures; nothing without contact surfaces. Pressures have the unit of --pressure, which the page does not know. */
tandem.pressureLegend = data => data.surfaces
  ? tandem.scaleLegend(data, "pressure-legend", "pressure on contact surfaces", part => tandem.number(part * data.most_pressure), null) : null;

/** Draws the contact surfaces of a frame. */
tandem.Surfaces = class {
  constructor(data, scene) {
    this.data = data;
    // Drawn after the bodies, which do not hide them or tint them, so that their colours are those of the legend.
    const look = new THREE.MeshBasicMaterial({vertexColors: THREE.VertexColors, side: THREE.DoubleSide, transparent: true});
    this.object = new THREE.Mesh(new THREE.BufferGeometry(), look);
    this.object.frustumCulled = false;
    this.object.renderOrder = 1;
    scene.add(this.object);
  }

  set visible(visible) {
    this.object.visible = visible;
  }

  show(frame) {
    const surfaces = this.data.surfaces[frame];
    const points = tandem.points(surfaces);
    const pressures = tandem.shorts(surfaces.pressures);
    const colours = new Float32Array(points.length);
    for (let i = 0; i < pressures.length; ++i) tandem.scaleColour(this.data, pressures[i] / 65535).toArray(colours, 3 * i);
    const triangles = [];
    let first = 0;
    for (const corners of tandem.bytes(surfaces.corners)) {  // polygons are convex
      for (let i = 2; i < corners; ++i) triangles.push(first, first + i - 1, first + i);
      first += corners;
    }
    const {geometry} = this.object;
    geometry.setAttribute("position", new THREE.BufferAttribute(points, 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3));
    geometry.setIndex(new THREE.BufferAttribute(new Uint32Array(triangles), 1));
  }
};
