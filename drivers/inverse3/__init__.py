"""The Haply Inverse3, reached through its maker's Inverse Service, which speaks JSON over a WebSocket."""
