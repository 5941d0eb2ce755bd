# SPDX-License-Identifier: MIT
# test: cost=10 full=20
"""The scene on a page of `tandem view` in Chromium fills its box, and leaves
scrolling to the page."""

import colorsys

from tests.program import LONG, tandem
from tests.report.case import ReportCase

CAMERA = "tandem.sceneView.camera.position.toArray().map(x => x.toFixed(4)).join()"
# {"r,g,b": [number of pixels, left, right, bottom, top]} of the colours but the background, as parts of the canvas.
COLOURS = """(() => {
  const c = document.getElementById('scene-canvas'), g = c.getContext('webgl2') || c.getContext('webgl');
  tandem.sceneView.draw();
  const pixels = new Uint8Array(4 * c.width * c.height), found = {};
  g.readPixels(0, 0, c.width, c.height, g.RGBA, g.UNSIGNED_BYTE, pixels);
  const ground = pixels.slice(0, 3).join();
  for (let i = 0; i < pixels.length / 4; ++i) {
    const name = pixels.slice(4 * i, 4 * i + 3).join(), x = i % c.width / c.width, y = Math.floor(i / c.width) / c.height;
    if (name === ground) continue;
    const [n, left, right, bottom, top] = found[name] ?? [0, 1, 0, 1, 0];
    found[name] = [n + 1, Math.min(left, x), Math.max(right, x + 1 / c.width), Math.min(bottom, y), Math.max(top, y + 1 / c.height)];
  }
  return found;
})()"""
MIDDLE = "(() => { const r = document.getElementById('scene-canvas').getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2]; })()"


class Scenes(ReportCase):
    def view(self, scene, width, height):
        page = self.work / "view.html"
        status, _, errors = tandem("view", *scene, "-o", page)
        self.assertEqual((status, errors), (0, []))
        self.browser.size(width, height, mobile=width < 500)
        self.opened(page)
        self.browser.until("Boolean(tandem.sceneView)")
        self.browser.run("new Promise(done => setTimeout(done, 300))")

    def test_the_scene_fills_its_box(self):
        for scene in (
            ("plates", "--frames", "20"),
            ("pile:bodies=60,frames=2", "--frames", "0"),
            ("pile:bodies=300,frames=1",),
        ):
            for width, height in ((1400, 900), (390, 844)) if LONG or scene[0] == "plates" else ((390, 844),):
                self.view(scene, width, height)
                _, left, right, bottom, top = zip(*self.browser.run(COLOURS).values())
                extent = min(left), max(right), min(bottom), max(top)
                self.assertGreater(max(extent[1] - extent[0], extent[3] - extent[2]), 0.8, (scene, width))
                self.assertTrue(min(extent) > 0 and max(extent) < 1, (scene, width, extent))

    def test_keys_buttons_and_choices(self):
        self.view(("plates", "--frames", "20:23", "--contacts"), 1280, 900)
        self.choose("view", "frame", 0, "input")
        seen = [self.browser.run(CAMERA)]
        self.browser.run("document.getElementById('scene-canvas').focus()")
        self.browser.key("ArrowRight")
        seen.append(self.browser.run(CAMERA))
        x, y = self.browser.run(MIDDLE)
        self.browser.drag([x, y], [x + 90, y + 30])
        self.assertEqual(len({*seen, self.browser.run(CAMERA)}), 3)
        words = r"^Frame 20: 3 bodies of 5,130 tetrahedra, \d+,\d{3} contacts\.$"
        self.assertRegex(self.text("#scene-words"), words)
        self.choose("view", "frame", 3, "input")
        self.assertIn("Frame 23:", self.text("#scene-words"))
        self.assertEqual(self.browser.run("tandem.sceneView.frame"), 3)
        self.browser.key("PageUp")
        self.assertIn("Frame 22:", self.text("#scene-words"))
        self.browser.run(
            "[...document.querySelectorAll('#view button')].find(b => b.textContent === 'Contacts').click()"
        )
        bodies = self.hues()
        self.choose("view", "colour", "chunk")
        self.assertGreater(self.hues(), 3 * bodies)

    def test_the_first_picture_is_of_the_frame_with_most_contacts(self):
        for contacts, frames in ((("--contacts",), "20:24"), ((), "0:4")):
            self.view(("plates", "--frames", frames, *contacts), 1280, 900)
            data = self.browser.run(
                "({frames: tandem.sceneView.data.frames, found: tandem.sceneView.data.contacts?.map(frame => frame.found)})"
            )
            expected = data["found"].index(max(data["found"])) if contacts else 4
            self.assertEqual(self.browser.run("tandem.sceneView.frame"), expected)
            self.assertEqual(self.browser.run("document.getElementById('frame-slider').value"), str(expected))
            self.assertIn(f"Frame {data['frames'][expected]}: ", self.text("#scene-words"))
        self.browser.run("document.querySelector('[aria-label=\"Play or pause\"]').click()")
        self.browser.until("tandem.sceneView.frame === 1")

    def test_contacts_grow_with_the_picture(self):
        parts = []
        for width, height in ((1400, 900), (716, 450)):  # of equal shape without their margins
            self.view(("plates", "--frames", "20", "--contacts"), width, height)
            count, *_ = zip(*self.pixels(0).values())
            canvas = self.browser.run(
                "(({width, height}) => [width, height])(document.getElementById('scene-canvas'))"
            )
            parts.append(sum(count) / canvas[1] ** 2)
        self.assertAlmostEqual(parts[0] / parts[1], 1, delta=0.25)
        self.browser.run("tandem.sceneView.camera.zoom = 2; tandem.sceneView.camera.updateProjectionMatrix()")
        nearer, *_ = zip(*self.browser.run(COLOURS).values())
        self.assertGreater(sum(nearer), 2 * sum(count))

    def hues(self):
        """The number of distinct hues, of 36, in the picture."""
        colours = ([int(part) / 255 for part in name.split(",")] for name in self.browser.run(COLOURS))
        seen = (colorsys.rgb_to_hls(*colour) for colour in colours)
        return len({int(36 * hue) for hue, _, saturation in seen if saturation > 0.5})

    def pixels(self, frame):
        """COLOURS of the contacts alone."""
        self.browser.run(
            f"tandem.sceneView.show({frame}); tandem.sceneView.objects.forEach(object => {{ object.visible = false; }})"
        )
        return self.browser.run(COLOURS)

    def test_contacts_have_the_colours_of_their_depths(self):
        self.view(("plates", "--frames", "20:21", "--contacts"), 1400, 900)
        data = self.browser.run(
            "({deepest: tandem.sceneView.data.deepest, depths: [0, 1].map(i => [...tandem.depthsOf(tandem.sceneView.data, i)])})"
        )
        deepest, depths = data["deepest"], data["depths"]
        self.assertEqual(max(map(max, depths)), 65534)
        self.assertGreater(deepest, 0)
        frame = 0 if 65534 in depths[0] else 1
        drawn = self.pixels(frame)
        self.assertIn("253,231,37", drawn)  # the deepest is yellow
        self.assertGreater(len(drawn), 10)  # others have colours between
        self.assertNotIn("255,45,149", drawn)
        legend = self.text("#depth-legend")
        for part in ("depth of contacts", f"{deepest:.4g} m", f"{deepest / 2:.4g} m"):
            self.assertIn(part, legend)

    def test_contacts_without_depth_are_plain(self):
        self.view(("plates", "--frames", "20", "--contacts"), 1400, 900)
        self.browser.run("tandem.sceneView.data.deepest = 0")
        drawn = self.pixels(0)  # edges are blended with the background
        self.assertEqual(max(drawn, key=drawn.get), "255,45,149")
        self.assertNotIn("253,231,37", drawn)
        self.assertIsNone(self.browser.run("tandem.depthLegend(tandem.sceneView.data)"))

    def test_surfaces_have_the_colours_of_their_pressures(self):
        pile = ("pile:bodies=6,refine=1,density=0.5,frames=2", "--pressure", "2e6", "--surfaces")
        self.view(pile, 1400, 900)
        looks = "tandem.sceneView.objects.map(({material}) => [material.transparent, material.opacity < 1])"
        self.assertEqual({*map(tuple, self.browser.run(looks))}, {(True, True)})
        self.assertGreater(self.hues(), 2)
        most = self.browser.run("tandem.sceneView.data.most_pressure")
        self.assertTrue(1e5 < most <= 2e6, most)
        legend = self.text("#pressure-legend")
        for part in ("pressure on contact surfaces", f"{round(most):,}"):
            self.assertIn(part, legend)
        self.assertRegex(self.text("#scene-words"), r"tetrahedra, [\d,]+ polygons\.$")
        triangles = "tandem.sceneView.surfaces.object.geometry.index.count / 3"
        corners = self.browser.run("[...tandem.bytes(tandem.sceneView.data.surfaces[1].corners)]")
        self.browser.run("tandem.sceneView.show(1)")
        self.assertEqual(self.browser.run(triangles), sum(corners) - 2 * len(corners))
        hide = "tandem.sceneView.objects.forEach(object => { object.visible = false; })"
        self.browser.run(hide)
        drawn = self.browser.run(COLOURS)
        self.assertGreater(len(drawn), 30, "colours between")
        greenness = max(int(green) - int(red) for red, green, _ in (name.split(",") for name in drawn))
        self.assertGreater(greenness, 60, "large pressures are green; small ones are violet")
        self.browser.run(
            "[...document.querySelectorAll('#view button')].find(b => b.textContent === 'Surfaces').click()"
        )
        self.assertEqual(self.browser.run(COLOURS), {}, "neither bodies nor surfaces")
        self.assertEqual({*map(tuple, self.browser.run(looks))}, {(False, False)})

    def scrolls(self):
        self.browser.run("document.getElementById('scene-canvas').scrollIntoView({block: 'center'})")
        return self.browser.run("scrollY"), self.browser.run(CAMERA), self.browser.run(MIDDLE)

    def now(self):
        self.browser.run("new Promise(done => setTimeout(done, 500))")
        return self.browser.run("scrollY"), self.browser.run(CAMERA)

    def test_the_wheel_scrolls_the_page(self):
        self.view(("plates", "--frames", "20"), 1400, 500)
        scrolled, camera, middle = self.scrolls()
        self.browser.wheel(middle, -100)
        now, same = self.now()
        self.assertEqual((now < scrolled, same), (True, camera))
        scrolled, camera, middle = self.scrolls()
        self.browser.wheel(middle, -100, control=True)
        now, zoomed = self.now()
        self.assertEqual(now, scrolled)
        self.assertNotEqual(zoomed, camera)

    def test_one_finger_scrolls_and_two_turn(self):
        self.view(("plates", "--frames", "20"), 390, 500)
        self.browser.ask("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=2)
        self.addCleanup(self.browser.ask, "Emulation.setTouchEmulationEnabled", enabled=False)
        scrolled, camera, (x, y) = self.scrolls()
        self.browser.fingers([[x, y], [x, y + 60]])
        now, same = self.now()
        self.assertEqual((now < scrolled, same), (True, camera))
        scrolled, camera, (x, y) = self.scrolls()
        self.browser.fingers([[x - 40, y], [x + 10, y]], [[x + 20, y], [x + 70, y]])
        now, turned = self.now()
        self.assertEqual(now, scrolled)
        self.assertNotEqual(turned, camera)

    def test_view_of_a_large_scene_is_reduced(self):
        page = self.work / "view.html"
        status, out, errors = tandem("view", "pile:bodies=4000,density=0.3,frames=60", "-o", page)
        self.assertEqual((status, errors), (0, []), out)
        self.assertLess(page.stat().st_size, 8e6)
        self.opened(page)
        words = self.browser.run("document.getElementById('view').textContent")
        self.assertIn("drawn as boxes", words)
        self.assertRegex(words, r"\d+ of 60 frames are shown")
        self.assertGreater(len(self.browser.run(COLOURS)), 3)  # bodies of one mesh have several

    def test_without_webgl(self):
        page = self.work / "plain.html"
        self.assertEqual(tandem("view", "plates", "--frames", "0:1", "-o", page)[0], 0)
        script = self.browser.ask(
            "Page.addScriptToEvaluateOnNewDocument",
            source="HTMLCanvasElement.prototype.getContext = () => null",
        )
        self.browser.open(page)
        self.browser.ask("Page.removeScriptToEvaluateOnNewDocument", identifier=script["identifier"])
        self.browser.until("Boolean(document.querySelector('#view .bad'))")
        self.assertIn("no WebGL", self.browser.run("document.getElementById('view').textContent"))
