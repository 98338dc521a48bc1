# SPDX-License-Identifier: GPL-3.0-or-later
"""A browser that sees a K40 laser on USB: umockdev shows the device, this answers the browser's own transfers (USBDEVFS ioctls).
Usage: umockdev-wrapper /usr/bin/python3 usb_k40.py CHROMIUM FLAG...

Prints a line of JSON for everything the laser hears. What is read from stdin: "spoil N" lets the next N packets arrive with a bit fallen over,
"pull" pulls the cable. Ends with the end of stdin."""
import errno
import fcntl
import json
import os
import struct
import subprocess
import sys
import threading

import gi

gi.require_version("UMockdev", "1.0")
from gi.repository import GLib, UMockdev

NODE = "bus/usb/001/005"
DESCRIPTORS = ("12011001ff000208861a1255040300020001"  # a CH341 in its parallel mode, 1a86:5512
               "0902270001010080300904000003ff010200"  # one interface of the vendor's own class
               "070582022000000705020220000007058103080001")  # bulk in 2, bulk out 2, interrupt in 1
DEVICE = f"""P: /devices/pci0000:00/0000:00:14.0/usb1/1-3
N: {NODE}
E: BUSNUM=001
E: DEVNAME=/dev/{NODE}
E: DEVNUM=005
E: DEVTYPE=usb_device
E: DRIVER=usb
E: ID_MODEL_ID=5512
E: ID_VENDOR_ID=1a86
E: PRODUCT=1a86/5512/304
E: SUBSYSTEM=usb
A: bConfigurationValue=1\\n
A: bNumConfigurations=1\\n
A: bcdDevice=0304\\n
A: busnum=1\\n
A: devnum=5\\n
A: idProduct=5512\\n
A: idVendor=1a86\\n
A: product=USB UART-LPT\\n
H: descriptors={DESCRIPTORS}
"""
SUBMIT, DISCARD, REAP, REAP_NOW = 10, 11, 12, 13
CONTROL, BULK = 2, 3
CRC = []
for byte in range(256):
    for _ in range(8):
        byte = byte >> 1 ^ (0x8C if byte & 1 else 0)
    CRC.append(byte)


def say(**what) -> None:
    print(json.dumps(what), flush=True)


class Board:
    """An M2Nano behind the chip: packets of 30 letters with their checksum, and a status that is asked for."""

    def __init__(self):
        self.status, self.spoil, self.finished_after = 206, 0, 0

    def out(self, data: bytes) -> None:
        if data == b"\xa0":
            return
        if len(data) != 34 or data[0] != 0xA6 or data[1] != 0 or data[32] != 0xA6:
            say(strange=data.hex())
            return
        letters = bytearray(data[2:32])
        if self.spoil > 0:
            self.spoil -= 1
            letters[7] ^= 0x10
        crc = 0
        for letter in letters:
            crc = CRC[crc ^ letter]
        self.status = 206 if crc == data[33] else 207
        say(packet=letters.decode("ascii", "replace"), good=crc == data[33])
        if b"FNSE" in letters and self.status == 206:
            self.finished_after = 8

    def ask(self) -> bytes:
        if self.finished_after > 0:
            self.finished_after -= 1
            if self.finished_after == 0:
                self.status = 236
        return bytes([255, self.status, 111, 8, 19, 0])


class Bell:
    """usbfs makes its node writable when a transfer is done, and browsers wait for that. A regular file, as umockdev makes it, cannot be waited
    for: a full pipe in its place can."""

    def __init__(self, path: str):
        os.unlink(path)
        os.mkfifo(path, 0o666)
        self.descriptor = os.open(path, os.O_RDWR | os.O_NONBLOCK)
        fcntl.fcntl(self.descriptor, 1031, 4096)  # F_SETPIPE_SZ
        self.ringing = True
        self.silence()

    def ring(self) -> None:
        if not self.ringing:
            os.read(self.descriptor, 65536)
            self.ringing = True

    def silence(self) -> None:
        if self.ringing:
            os.write(self.descriptor, bytes(4096))
            self.ringing = False


class Transfers:
    """struct usbdevfs_urb: type, endpoint, status at 4, flags at 8, buffer at 16, length at 24, actual length at 28."""

    def __init__(self, board: Board, bell: Bell):
        self.board, self.bell, self.done, self.gone = board, bell, [], False

    def handle(self, _handler, client) -> bool:
        try:
            result, error = self.answer(client)
        except Exception as mishap:  # whatever it is, the browser must not wait for ever
            say(mishap=repr(mishap))
            result, error = -1, errno.EIO
        client.complete(result, error)
        return True

    def answer(self, client) -> tuple[int, int]:
        number = client.get_request() & 0xFF
        if self.gone:
            return -1, errno.ENODEV
        if number == SUBMIT:
            urb = client.get_arg().resolve(0, 56)
            kind, endpoint, length = struct.unpack_from("<BB22xi", bytes(urb.retrieve()))
            buffer = urb.resolve(16, length) if length else None
            data = bytes(buffer.retrieve()) if buffer else b""
            answer, count = b"", length
            if kind == CONTROL:
                request, value, index = data[1], *struct.unpack_from("<HH", data, 2)
                say(control=[data[0], request, value, index])
                count = length - 8
            elif kind == BULK and endpoint == 0x02:
                self.board.out(data)
            elif kind == BULK and endpoint == 0x82:
                answer = self.board.ask()
                count = len(answer)
            else:
                say(strange=f"transfer of kind {kind} at endpoint {endpoint:#x}")
            if answer:
                buffer.update(0, list(answer))
            self.done.append((urb, count))
            self.bell.ring()
            return 0, 0
        if number in (REAP, REAP_NOW):
            if not self.done:
                return -1, errno.EAGAIN
            urb, count = self.done.pop(0)
            urb.update(4, list(struct.pack("<i", 0)))
            urb.update(28, list(struct.pack("<i", count)))
            client.get_arg().resolve(0, 8).set_ptr(0, urb)
            if not self.done:
                self.bell.silence()
            return 0, 0
        if number != DISCARD:
            say(ioctl=number)
        return 0, 0


def main() -> None:
    testbed = UMockdev.Testbed.new()
    testbed.add_from_string(DEVICE)
    board, bell = Board(), Bell(f"{testbed.get_root_dir()}/dev/{NODE}")
    transfers = Transfers(board, bell)
    handler = UMockdev.IoctlBase.new()
    handler.connect("handle-ioctl", transfers.handle)
    testbed.attach_ioctl(f"/dev/{NODE}", handler)
    threading.Thread(target=GLib.MainLoop().run, daemon=True).start()
    browser = subprocess.Popen(sys.argv[1:], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=open(os.environ["BROWSER_LOG"], "w") if "BROWSER_LOG" in os.environ else subprocess.DEVNULL)
    say(ready=True)
    try:
        for line in sys.stdin:
            words = line.split()
            if words[:1] == ["spoil"]:
                board.spoil = int(words[1])
            elif words == ["pull"]:
                transfers.gone = True
                testbed.uevent("/sys/devices/pci0000:00/0000:00:14.0/usb1/1-3", "remove")
                bell.ring()
    finally:
        browser.terminate()
        browser.wait()


main()
