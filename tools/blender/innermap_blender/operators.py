"""Bake, Live, Clear and Check the body."""

import threading
import time

import bpy

from . import library, stale, targets
from .geometry import Refused, body_mesh
from .job import Job

# RuntimeError is the base of the module's own.
FAULTS = (Refused, ValueError, OSError, RuntimeError, library.Missing)
TOGETHER = 0.2  # seconds of frames that are read before the window is drawn again
VERDICT = {}  # of bodies: lines for the panel


def lines_of(report):
    if report.closed and not report.self_intersections and report.outward:
        return [f"a solid, {report.triangles} triangles"]
    out = []
    if not report.closed:
        out.append(f"open: {report.open_loops} holes, closed by guess")
    if not report.outward:
        out.append("faces point inward; turned round")
    if report.self_intersections:
        out.append(f"{report.self_intersections} pairs of faces cross")
    return out


def judge(body, report):
    VERDICT[body.name] = lines = lines_of(report)
    return lines


class Working:
    """An operator that does a Job: in scripts at once, in a window beside what the user does."""

    bl_options = {'REGISTER', 'UNDO'}
    live = False
    running = False  # in a window, one at a time
    shown = ""

    @classmethod
    def poll(cls, context):
        return not Working.running and context.mode == 'OBJECT' and \
            context.scene.innermap.body is not None

    def fail(self, text):
        self.report({'ERROR'}, text)
        return {'CANCELLED'}

    def finish(self):
        job = self.job
        try:
            if job.error:
                return self.fail(job.error)
            if job.cancelled:
                self.report({'WARNING'}, "cancelled; nothing was changed")
                return {'CANCELLED'}
            told = job.write()
        except ReferenceError:
            return self.fail("an object was deleted meanwhile; bake again")
        except FAULTS as error:
            return self.fail(str(error))
        finally:
            job.close()
        for text in judge(job.body, job.report)[:1] if not job.report.closed else ():
            told.append(('WARNING', f"{job.body.name}: {text}"))
        for kind, text in told[::-1]:
            self.report({kind}, text)
        return {'FINISHED'}

    def execute(self, context):
        try:
            self.job = Job(context, self.live)
            for _ in self.job.collect():
                pass
        except FAULTS as error:
            return self.fail(str(error))
        self.job.compute()
        return self.finish()

    def invoke(self, context, _event):
        if bpy.app.background:
            return self.execute(context)
        try:
            self.job = Job(context, self.live)
        except FAULTS as error:
            return self.fail(str(error))
        self.steps, self.thread, Working.running = self.job.collect(), None, True
        context.window_manager.progress_begin(0, 100)
        self.timer = context.window_manager.event_timer_add(0.05, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {'RUNNING_MODAL'}

    def end(self, context):
        Working.running = False
        context.window_manager.event_timer_remove(self.timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)

    def show(self, context, text, share):
        text = f"Inner map: {text} {share:.0%}    Esc: cancel"
        if text == self.shown:
            return
        self.shown = text
        context.window_manager.progress_update(100 * share)
        context.workspace.status_text_set(text)

    def modal(self, context, event):
        try:
            return self.step(context, event)
        except BaseException:  # or no other bake could begin until Blender is started again
            self.job.cancelled = True
            if Working.running:
                self.end(context)
            raise

    def step(self, context, event):
        job = self.job
        if event.type == 'ESC':
            job.cancelled = True
        if event.type == 'Z' and (event.ctrl or event.oskey):
            return {'RUNNING_MODAL'}  # undoing makes all objects anew, which the job knows
        if event.type != 'TIMER':
            # While the animation is stepped through nothing else may change the scene.
            return {'PASS_THROUGH'} if self.thread and event.type != 'ESC' else {'RUNNING_MODAL'}
        if self.thread is None:
            return self.collect(context)
        self.show(context, job.stage, job.share)
        if not job.done:
            return {'RUNNING_MODAL'}
        self.thread.join()
        self.end(context)
        return self.finish()

    def collect(self, context):
        until = time.monotonic() + TOGETHER
        try:
            share = None if self.job.cancelled else 0
            while share is not None and share <= 1 and time.monotonic() < until:
                share = next(self.steps, 1.5)
        except FAULTS as error:
            self.end(context)
            self.job.close()
            return self.fail(str(error))
        if share is None:
            self.steps.close()
            self.end(context)
            return self.finish()
        if share <= 1:
            self.show(context, f"reading {self.job.body.name}", share)
            return {'RUNNING_MODAL'}
        self.thread = threading.Thread(target=self.job.compute, daemon=True)
        self.thread.start()
        return {'RUNNING_MODAL'}


class INNERMAP_OT_bake(Working, bpy.types.Operator):
    bl_idname = "innermap.bake"
    bl_label = "Bake"
    bl_description = "Carry the objects inside the body through its animation"


class INNERMAP_OT_live(Working, bpy.types.Operator):
    bl_idname = "innermap.live"
    bl_label = "Live"
    bl_description = ("Make a lattice that follows the body's inside. Objects with its Lattice "
                      "modifier follow too, also if you change or add them later")
    live = True


class INNERMAP_OT_clear(bpy.types.Operator):
    bl_idname = "innermap.clear"
    bl_label = "Clear"
    bl_description = "Remove the bake; files stay where they are"
    bl_options = {'REGISTER', 'UNDO'}

    @classmethod
    def poll(cls, context):
        return not Working.running and context.mode == 'OBJECT'

    def execute(self, context):
        baked = [ob for ob in context.scene.objects if ob.get("innermap_baked")]
        count = sum(targets.clear(ob) for ob in baked)
        stale.forget(context.scene)
        self.report({'INFO'}, f"cleared {count} objects")
        return {'FINISHED'}


class INNERMAP_OT_check(bpy.types.Operator):
    bl_idname = "innermap.check"
    bl_label = "Check the body"
    bl_description = "Says whether the body is a solid: closed, outward, not through itself"

    @classmethod
    def poll(cls, context):
        return context.scene.innermap.body is not None

    def execute(self, context):
        body = context.scene.innermap.body
        try:
            report = library.module().check(*body_mesh(body))
        except FAULTS as error:
            self.report({'ERROR'}, str(error))
            return {'CANCELLED'}
        lines = judge(body, report)
        good = report.closed and not report.self_intersections
        self.report({'INFO' if good else 'WARNING'}, f"{body.name}: " + "; ".join(lines))
        stale.look(context.scene)
        return {'FINISHED'}


CLASSES = (INNERMAP_OT_bake, INNERMAP_OT_live, INNERMAP_OT_clear, INNERMAP_OT_check)
