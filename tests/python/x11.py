"""The little of Xlib that a person's desktop does and xdotool does not: dropping files (XDND, version 5), telling a
program that it is minimised (ICCCM WM_STATE) or maximised (EWMH _NET_WM_STATE), how fine the display is (the resource
Xft.dpi).
"""

import contextlib
import ctypes
import ctypes.util
import time

X = ctypes.CDLL(ctypes.util.find_library("X11") or "libX11.so.6")
Atom = Window = ctypes.c_ulong
CLIENT_MESSAGE, SELECTION_REQUEST, SELECTION_NOTIFY, PROP_REPLACE, XA_ATOM, XA_STRING, XA_WINDOW = 33, 30, 31, 0, 4, 31, 33

X.XOpenDisplay.restype = ctypes.c_void_p
X.XInternAtom.restype = X.XDefaultRootWindow.restype = X.XCreateSimpleWindow.restype = ctypes.c_ulong
X.XInternAtom.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int]
X.XDefaultRootWindow.argtypes = X.XPending.argtypes = [ctypes.c_void_p]
X.XCloseDisplay.argtypes = [ctypes.c_void_p]
X.XSync.argtypes = [ctypes.c_void_p, ctypes.c_int]
X.XCreateSimpleWindow.argtypes = [
    ctypes.c_void_p, Window, *[ctypes.c_int] * 2, *[ctypes.c_uint] * 3, *[ctypes.c_ulong] * 2]
X.XSetSelectionOwner.argtypes = [ctypes.c_void_p, Atom, Window, ctypes.c_ulong]
X.XChangeProperty.argtypes = [
    ctypes.c_void_p, Window, Atom, Atom, ctypes.c_int, ctypes.c_int, ctypes.c_void_p, ctypes.c_int]
X.XDeleteProperty.argtypes = [ctypes.c_void_p, Window, Atom]
X.XSendEvent.argtypes = [ctypes.c_void_p, Window, ctypes.c_int, ctypes.c_long, ctypes.c_void_p]
X.XNextEvent.argtypes = [ctypes.c_void_p, ctypes.c_void_p]
X.XGetWindowProperty.argtypes = [
    ctypes.c_void_p, Window, Atom, ctypes.c_long, ctypes.c_long, ctypes.c_int, Atom, *[ctypes.c_void_p] * 5]
X.XFree.argtypes = [ctypes.c_void_p]

_HEAD = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int), ("display", ctypes.c_void_p)]


class ClientMessage(ctypes.Structure):
    _fields_ = [*_HEAD, ("window", Window), ("message_type", Atom), ("format", ctypes.c_int),
                ("data", ctypes.c_long * 5)]


class SelectionRequest(ctypes.Structure):
    _fields_ = [*_HEAD, ("owner", Window), ("requestor", Window), ("selection", Atom), ("target", Atom),
                ("property", Atom), ("time", ctypes.c_ulong)]


class SelectionNotify(ctypes.Structure):
    _fields_ = [*_HEAD, ("requestor", Window), ("selection", Atom), ("target", Atom), ("property", Atom),
                ("time", ctypes.c_ulong)]


class Event(ctypes.Union):
    _fields_ = [("type", ctypes.c_int), ("client", ClientMessage), ("request", SelectionRequest),
                ("notify", SelectionNotify), ("pad", ctypes.c_long * 24)]


class Server:
    def __init__(self, name):
        self.display = X.XOpenDisplay(name.encode())
        assert self.display, name
        self.root = X.XDefaultRootWindow(self.display)

    def close(self):
        X.XCloseDisplay(self.display)

    def atom(self, name):
        return X.XInternAtom(self.display, name.encode(), 0)

    def put(self, window, name, kind, values):
        """A property of 32 bit numbers (Xlib wants them as longs), or of bytes."""
        is_text = isinstance(values, bytes)
        data = ctypes.create_string_buffer(values) if is_text else (ctypes.c_long * len(values))(*values)
        X.XChangeProperty(self.display, window, self.atom(name), kind, 8 if is_text else 32, PROP_REPLACE, data,
                          len(values))
        X.XSync(self.display, 0)

    def get(self, window, name):
        """The 32 bit numbers of a property; none where it is not there."""
        kind, format_, count, left, data = Atom(), ctypes.c_int(), ctypes.c_ulong(), ctypes.c_ulong(), ctypes.c_void_p()
        X.XGetWindowProperty(self.display, window, self.atom(name), 0, 1024, 0, 0, *map(
            ctypes.byref, (kind, format_, count, left, data)))
        if not data.value:
            return []
        values = ctypes.cast(data, ctypes.POINTER(ctypes.c_long))[: count.value] if format_.value == 32 else []
        X.XFree(data)
        return list(values)

    def send(self, window, message, *data):
        event = Event(client=ClientMessage(type=CLIENT_MESSAGE, display=self.display, window=window,
                                           message_type=self.atom(message), format=32, data=(ctypes.c_long * 5)(*data)))
        X.XSendEvent(self.display, window, 0, 0, ctypes.byref(event))
        X.XSync(self.display, 0)

    def next(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if X.XPending(self.display):
                event = Event()
                X.XNextEvent(self.display, ctypes.byref(event))
                return event
            time.sleep(0.01)
        raise TimeoutError("the other side of the drop does not answer")


@contextlib.contextmanager
def server(name):
    made = Server(name)
    try:
        yield made
    finally:
        made.close()


def drop(display, window, x, y, uris, seconds):
    """Drags a list of URIs over a window and lets go at (x, y) of the screen, as a file manager does."""
    with server(display) as s:
        source = X.XCreateSimpleWindow(s.display, s.root, 0, 0, 1, 1, 0, 0, 0)
        selection, kind = s.atom("XdndSelection"), s.atom("text/uri-list")
        X.XSetSelectionOwner(s.display, selection, source, 0)
        s.send(window, "XdndEnter", source, 5 << 24, kind, 0, 0)
        s.send(window, "XdndPosition", source, 0, x << 16 | y, 0, s.atom("XdndActionCopy"))
        while True:
            event = s.next(seconds)
            if event.type == SELECTION_REQUEST:
                asked = event.request
                X.XChangeProperty(s.display, asked.requestor, asked.property, asked.target, 8, PROP_REPLACE,
                                  ctypes.create_string_buffer(uris), len(uris))
                answer = Event(notify=SelectionNotify(type=SELECTION_NOTIFY, display=s.display,
                                                      requestor=asked.requestor, selection=asked.selection,
                                                      target=asked.target, property=asked.property, time=asked.time))
                X.XSendEvent(s.display, asked.requestor, 0, 0, ctypes.byref(answer))
                X.XSync(s.display, 0)
            elif event.type == CLIENT_MESSAGE and event.client.message_type == s.atom("XdndStatus"):
                assert event.client.data[1] & 1, "the window does not take files"
                s.send(window, "XdndDrop", source, 0, 0, 0, 0)
            elif event.type == CLIENT_MESSAGE and event.client.message_type == s.atom("XdndFinished"):
                return


def set_minimised(display, window, minimised):
    """What a window manager says of a window: 1 normal, 3 iconic."""
    with server(display) as s:
        s.put(window, "WM_STATE", s.atom("WM_STATE"), [3 if minimised else 1, 0])


MAXIMISED = ("_NET_WM_STATE_MAXIMIZED_VERT", "_NET_WM_STATE_MAXIMIZED_HORZ")


@contextlib.contextmanager
def window_manager(display):
    """Says that one is there which can maximise windows (EWMH), for programs that start within."""
    with server(display) as s:
        itself = X.XCreateSimpleWindow(s.display, s.root, 0, 0, 1, 1, 0, 0, 0)
        for window in (itself, s.root):
            s.put(window, "_NET_SUPPORTING_WM_CHECK", XA_WINDOW, [itself])
        s.put(s.root, "_NET_SUPPORTED", XA_ATOM, [s.atom(name) for name in ("_NET_WM_STATE", *MAXIMISED)])
        try:
            yield
        finally:
            for name in ("_NET_SUPPORTING_WM_CHECK", "_NET_SUPPORTED"):
                X.XDeleteProperty(s.display, s.root, s.atom(name))
            X.XSync(s.display, 0)


def set_maximised(display, window):
    """What a window manager says of a window that it maximised."""
    with server(display) as s:
        s.put(window, "_NET_WM_STATE", XA_ATOM, [s.atom(name) for name in MAXIMISED])


def is_maximised(display, window):
    with server(display) as s:
        return {s.atom(name) for name in MAXIMISED} <= set(s.get(window, "_NET_WM_STATE"))


@contextlib.contextmanager
def dots_per_inch(display, dpi):
    """For programs that start within."""
    with server(display) as s:
        s.put(s.root, "RESOURCE_MANAGER", XA_STRING, f"Xft.dpi:\t{dpi}\n".encode())
        try:
            yield
        finally:
            X.XDeleteProperty(s.display, s.root, s.atom("RESOURCE_MANAGER"))
            X.XSync(s.display, 0)
