"""Critical speeds: modes over speed, where order lines meet them, and the peaks there."""
