"""`accdec explore --no-browser` as a child, and questions to it."""
import http.client
import json
import subprocess
import urllib.parse


class Program:
    def __init__(self, accdec, *arguments, cwd=None):
        self.process = subprocess.Popen([accdec, "explore", "--no-browser", *map(str, arguments)], cwd=cwd,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.address = self.process.stdout.readline().strip()
        if not self.address:
            raise RuntimeError(self.process.stderr.read())
        parts = urllib.parse.urlsplit(self.address)
        self.host, self.path = parts.netloc, parts.path.rsplit("/", 1)[0] + "/"
        self.port = parts.port

    def ask(self, method, path, body=None, headers=None, host=None):
        """(status, body); the host of the address unless another is given."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
        for name, value in {"Host": host or self.host, **(headers or {})}.items():
            connection.putheader(name, value)
        if body is not None:
            connection.putheader("Content-Length", str(len(body)))
        connection.endheaders()
        try:
            if body is not None:
                connection.send(body)
        except (BrokenPipeError, ConnectionResetError):
            pass  # refused before all of it was sent; the answer is there
        answer = connection.getresponse()
        text = answer.read()
        connection.close()
        return answer.status, text

    def post(self, name, value, **query):
        body = value if isinstance(value, bytes) else json.dumps(value).encode()
        return self.ask(
            "POST", f"{self.path}{name}?{urllib.parse.urlencode(query)}", body, {"Content-Type": "application/json"}
        )

    def end(self):
        self.process.terminate()
        self.process.wait(20)
