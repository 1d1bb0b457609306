; The tick: 1024 times a second it feeds the watchdog, ends the sync pulse, and counts how long
; the host has been silent. The watchdog is fed nowhere else, and only from the main loop after
; the interrupt ran: if either stops, the chip resets.

        include "board.inc"

        global  tick_init, tick_interrupt, tick_poll, host_heard, sync_rise
        extern  flags, silence_trips, outputs_stop, forget_request, faults_check_state

tick_vars udata_acs
ticks           res     1       ; counted by the interrupt
ticks_seen      res     1       ; handled by the main loop
silence_left    res     2       ; ticks until the drive is stopped
sync_left       res     1       ; ticks until the sync pin falls

tick_code code
tick_init:
        clrf    ticks
        clrf    ticks_seen
        clrf    sync_left
        call    host_heard
        movlw   TICK_PERIOD
        movwf   PR2
        clrf    TMR2
        movlw   TICK_T2CON
        movwf   T2CON
        bcf     PIR1, TMR2IF
        bsf     PIE1, TMR2IE
        return

tick_interrupt:
        bcf     PIR1, TMR2IF
        incf    ticks, F
        return

; A valid frame came.
host_heard:
        movlw   low SILENCE_TICKS
        movwf   silence_left
        movlw   high SILENCE_TICKS
        movwf   silence_left + 1
        return

sync_rise:
        bsf     LATB, SYNC_PIN
        movlw   SYNC_TICKS
        movwf   sync_left
        return

tick_poll:
        movf    ticks, W
        xorwf   ticks_seen, W
        bz      tick_done
        incf    ticks_seen, F
        clrwdt
        call    faults_check_state
        movf    sync_left, F
        bz      sync_is_low
        decfsz  sync_left, F
        bra     sync_is_low
        bcf     LATB, SYNC_PIN
sync_is_low:
        btfss   flags, FLAG_OUTPUTS_ON_BIT
        bra     tick_done
        movlw   0
        decf    silence_left, F
        subwfb  silence_left + 1, F
        movf    silence_left, W
        iorwf   silence_left + 1, W
        bz      host_is_silent
tick_done:
        return

host_is_silent:
        call    outputs_stop
        call    forget_request
        bsf     flags, FLAG_HOST_SILENCE_BIT
        incfsz  silence_trips, F
        return
        setf    silence_trips           ; stops at 255
        return

        end
