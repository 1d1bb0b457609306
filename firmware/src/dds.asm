; The two AD9833 chips on one SPI bus (CKP = 1, CKE = 1, 1.84 MHz: they latch on the falling edge).
;
; Each chip has two frequency and two phase registers. A new value goes into the one that is not in
; use; then one control word, sent with both FSYNC low, selects it in both chips at the same clock
; edge. Generator A is the reference: its phase registers hold 0 from start-up on. The wire to the
; chips is read back (RC4), and a setting whose words did not arrive on it as sent is never selected.

        include "board.inc"

        global  dds_init, dds_set_drive, dds_set_phase, dds_check_port, outputs_start, outputs_stop
        global  new_frequency, new_phase, frequency_word, phase_word, dds_error
        extern  flags, sync_rise

; AD9833 data sheet: control bits, and the addresses of the registers, both in the high byte
CONTROL_B28             equ     0x20    ; a frequency comes as two words, low half first
CONTROL_FSELECT_BIT     equ     3
CONTROL_PSELECT_BIT     equ     2
CONTROL_RESET           equ     0x01
CONTROL_LOW             equ     0x28    ; OPBITEN and DIV2: the accumulator's top bit, undivided
FREQ0                   equ     0x40
FREQ1                   equ     0x80
PHASE0                  equ     0xC0
PHASE1                  equ     0xE0

SPI_MODE                equ     0x31    ; SSPEN, CKP, Fosc / 16

dds_vars udata_acs
new_frequency   res     4       ; to be applied
new_phase       res     2
frequency_word  res     4       ; in force, in both chips
phase_word      res     2       ; in force in chip B, low 12 bits; chip A has 0
selected        res     1       ; FSELECT and PSELECT in force
chips           res     1       ; FSYNC bits of the chips that the next word goes to
word_low        res     1
word_high       res     1
sent            res     1
dds_error       res     1       ; not 0: a byte did not arrive as it was sent
address         res     1
rotated         res     1

dds_code code
dds_init:
        clrf    dds_error
        clrf    selected
        movlw   (1 << CKE)
        movwf   SSPSTAT
        movlw   SPI_MODE
        movwf   SSPCON1
        rcall   send_control            ; RESET first: the registers hold anything after power-on
        clrf    new_frequency
        clrf    new_frequency + 1
        clrf    new_frequency + 2
        clrf    new_frequency + 3
        clrf    new_phase
        clrf    new_phase + 1
        rcall   note_frequency
        rcall   note_phase
        movlw   FREQ0
        rcall   send_frequency
        movlw   FREQ1
        rcall   send_frequency
        movlw   PHASE0
        rcall   send_phase              ; FSYNC_BOTH is still chosen
        movlw   PHASE1
        bra     send_phase

; Have `new_frequency` and `new_phase` take force, both chips at once. `dds_error` tells of failure.
dds_set_drive:
        movlw   FREQ1
        btfsc   selected, CONTROL_FSELECT_BIT
        movlw   FREQ0
        rcall   send_frequency
        rcall   load_phase
        tstfsz  dds_error
        return
        btg     selected, CONTROL_FSELECT_BIT
        btg     selected, CONTROL_PSELECT_BIT
        rcall   send_control
note_frequency:
        movff   new_frequency, frequency_word
        movff   new_frequency + 1, frequency_word + 1
        movff   new_frequency + 2, frequency_word + 2
        movff   new_frequency + 3, frequency_word + 3
note_phase:
        movff   new_phase, phase_word
        movff   new_phase + 1, phase_word + 1
        return

; Have `new_phase` take force.
dds_set_phase:
        rcall   load_phase
        tstfsz  dds_error
        return
        btg     selected, CONTROL_PSELECT_BIT
        rcall   send_control
        bra     note_phase

load_phase:
        movlw   0x0F
        andwf   new_phase + 1, F
        movlw   (1 << FSYNC_B)
        movwf   chips
        movlw   PHASE1
        btfsc   selected, CONTROL_PSELECT_BIT
        movlw   PHASE0
; `new_phase` into the register at address W of the chosen chips.
send_phase:
        movwf   word_high
        movf    new_phase + 1, W
        iorwf   word_high, F
        movff   new_phase, word_low
        bra     send_word

outputs_start:
        bsf     flags, FLAG_OUTPUTS_ON_BIT
        rcall   send_control
        tstfsz  dds_error
        return
        bsf     LATC, ENABLE
        return

outputs_stop:
        bcf     LATC, ENABLE            ; the power stage first: it needs no chip to obey
        bcf     flags, FLAG_OUTPUTS_ON_BIT
; Select the registers and the RESET state in both chips. No interrupt comes between the word and the
; sync pin's edge (13 us), so the edge always comes the same time after it.
send_control:
        movf    selected, W
        iorlw   CONTROL_B28
        btfss   flags, FLAG_OUTPUTS_ON_BIT
        iorlw   CONTROL_RESET
        movwf   word_high
        movlw   CONTROL_LOW
        movwf   word_low
        movlw   FSYNC_BOTH
        movwf   chips
        bcf     LATB, SYNC_PIN
        bcf     INTCON, GIE
        rcall   send_word
        call    sync_rise
        bsf     INTCON, GIE
        return

; `new_frequency` into the register at address W of both chips: low 14 bits, then high 14 bits.
send_frequency:
        movwf   address
        movlw   FSYNC_BOTH
        movwf   chips
        movff   new_frequency, word_low
        movf    new_frequency + 1, W
        andlw   0x3F
        iorwf   address, W
        movwf   word_high
        rcall   send_word
        rlncf   new_frequency + 1, W    ; bits 15 and 14 to the bottom
        movwf   word_low
        rlncf   word_low, F
        movlw   0x03
        andwf   word_low, F
        rlncf   new_frequency + 2, W
        movwf   word_high
        rlncf   word_high, W            ; bits 21..16, then 23 and 22 at the bottom
        andlw   0xFC
        iorwf   word_low, F
        rlncf   word_high, W
        andlw   0x03
        movwf   word_high
        rlncf   new_frequency + 3, W
        movwf   rotated
        rlncf   rotated, W              ; bits 27..24
        andlw   0x3C
        iorwf   word_high, F
        movf    address, W
        iorwf   word_high, F            ; and on into send_word

send_word:
        comf    chips, W
        andwf   LATC, F                 ; the chosen FSYNC fall in the same cycle
        movf    word_high, W
        rcall   send_byte
        movf    word_low, W
        rcall   send_byte
        movf    chips, W
        iorwf   LATC, F
        return

send_byte:
        movwf   sent
        movwf   SSPBUF
not_sent:
        btfss   SSPSTAT, BF
        bra     not_sent
        movf    SSPBUF, W               ; what was on the wire
        xorwf   sent, W
        iorwf   dds_error, F
        return

; Z set where the power stage, the pins and the bus are as the flags say.
dds_check_port:
        movlw   0
        btfsc   flags, FLAG_OUTPUTS_ON_BIT
        movlw   (1 << ENABLE)
        iorlw   FSYNC_BOTH
        xorwf   LATC, W
        andlw   (1 << ENABLE) | FSYNC_BOTH
        bnz     port_differs
        movlw   TRISC_RUN
        xorwf   TRISC, W
        bnz     port_differs
        movlw   SPI_MODE
        xorwf   SSPCON1, W
port_differs:
        return

        end
