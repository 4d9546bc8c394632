"""The independent reference: separate equations of motion, integrated from event to event."""
