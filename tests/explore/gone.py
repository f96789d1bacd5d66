"""Pages that are closed, or loaded again, while their searches are under way."""
import json
import socket
import time

most = 12  # questions at a time


def gone(check, p, task):
    """Searches end with the connections that asked for them: a page that is loaded again finds the program free."""
    body = json.dumps({**task, "sample_period_ms": 0.05, "design": {"order_max": 3000},
                       "mode": [{"frequency_Hz": [10, 60], "residual_max": 0.02}],
                       "corner": [{"angle_deg": 40 + 20 * i, "feed_in_mm_min": 9000, "error_max_um": 30}
                                  for i in range(5)]}).encode()
    asking = []
    for i in range(most):
        asking.append(socket.create_connection(("127.0.0.1", p.port)))
        head = (f"POST {p.path}design?seconds=60&client=gone{i} HTTP/1.1\r\nHost: {p.host}\r\n"
                f"Content-Type: application/json\r\nContent-Length: {len(body)}\r\n\r\n")
        asking[-1].sendall(head.encode() + body)
    small = {"sample_period_ms": 1, "corner": [{"angle_deg": 90, "feed_in_mm_min": 6000}]}
    until = time.monotonic() + 10
    while (status := p.post("design", small, client="next")[0]) == 200 and time.monotonic() < until:
        time.sleep(0.05)
    check(status == 503, f"{most} searches are as many as the program does at a time")
    for one in asking:
        one.close()
    began = time.monotonic()
    while (status := p.post("design", small, client="next")[0]) == 503 and time.monotonic() < began + 10:
        time.sleep(0.05)
    check(status == 200 and time.monotonic() - began < 5.0,
          f"their pages are gone, and so are they {time.monotonic() - began:.2f} s later")
