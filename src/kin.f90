!> Level 5. The same program in another kind of reals, started beside this one: kinmat-quad knows the truth.
module kin
   use, intrinsic :: iso_c_binding, only: c_ptr, c_int, c_size_t, c_char, c_loc, c_associated, c_null_char
   use, intrinsic :: iso_fortran_env, only: dp => real64, qp => real128
   use failures, only: failure_t, fail, status_machine, status_refused
   use trial_forms, only: trial_t, outcome_t, word_of, samples_of
   use trial_records, only: head_length, is_head, make_room, parts_of
   implicit none
   private
   public :: ask_kin

   interface
      type(c_ptr) function popen(command, mode) bind(c)
         import :: c_ptr, c_char
         character(kind=c_char), intent(in) :: command(*), mode(*)
      end function popen
      integer(c_int) function pclose(stream) bind(c)
         import :: c_ptr, c_int
         type(c_ptr), value :: stream
      end function pclose
      integer(c_size_t) function fread(place, length, count, stream) bind(c)
         import :: c_ptr, c_size_t
         type(c_ptr), value :: place, stream
         integer(c_size_t), value :: length, count
      end function fread
   end interface

   !> What a shell gives back where it does not find a program.
   integer, parameter :: not_found = 127

contains

   !> Lets `program` (kinmat-quad or kinmat-single), whose kind has so many binary `digits`, try the `trials` on the
   !> deck in the file `deck`; `links` (trials): of their sets. `outcomes` (trials): what came of them. Errors:
   !> status_refused, the deck holds numbers that are none in that kind; status_machine.
   subroutine ask_kin(program, digits, deck, trials, links, outcomes, failure)
      character(*), intent(in) :: program, deck
      integer, intent(in) :: digits, links(:)
      type(trial_t), intent(in) :: trials(:)
      type(outcome_t), allocatable, intent(out) :: outcomes(:)
      type(failure_t), allocatable, intent(out) :: failure
      character(:), allocatable :: words
      type(c_ptr) :: stream
      logical :: complete
      integer :: i, status

      allocate (outcomes(size(trials)))
      if (size(trials) == 0) return
      words = ''
      do i = 1, size(trials)
         words = words//' '//word_of(trials(i))
      end do
      flush (6)
      stream = popen(shell_word(beside(program))//' --trials '//shell_word(words(2:))//' '//shell_word(deck) &
         //' 2>/dev/null'//c_null_char, 'r'//c_null_char)
      if (.not. c_associated(stream)) then
         call fail(failure, status_machine, program//' CANNOT BE STARTED')
         return
      end if
      do i = 1, size(trials)
         call read_record(stream, digits, links(i), samples_of(trials(i)), outcomes(i), complete)
         if (.not. complete) exit
      end do
      status = pclose(stream)/256
      if (status == status_refused) then
         call fail(failure, status_refused, program//' REFUSES THE DECK')
      else if (status == not_found) then
         call fail(failure, status_machine, '--study NEEDS '//program//' BESIDE THIS PROGRAM OR IN PATH: make kinds')
      else if (.not. complete) then
         call fail(failure, status_machine, program &
            //' HAS GIVEN NO RESULTS, OR NOT THOSE ASKED FOR (IS IT OF ANOTHER VERSION? make kinds)')
      end if
   end subroutine ask_kin

   !> One outcome; not `complete`: there is none, or not of what was asked for.
   subroutine read_record(stream, digits, links, samples, one, complete)
      type(c_ptr), intent(in) :: stream
      integer, intent(in) :: digits, links, samples
      type(outcome_t), intent(out), target :: one
      logical, intent(out) :: complete
      character(head_length), target :: head
      real(dp), target :: iterations
      integer :: bytes(4)

      complete = take(stream, c_loc(head), head_length)
      if (complete) complete = is_head(head, digits, links, samples)
      if (.not. complete) return
      call make_room(head, one)
      bytes = parts_of(one)
      complete = take(stream, c_loc(iterations), bytes(1))
      if (complete .and. size(one%time) > 0) complete = take(stream, c_loc(one%time), bytes(2))
      if (complete) complete = take(stream, c_loc(one%known), bytes(3))
      if (complete) complete = take(stream, c_loc(one%value), bytes(4))
      if (complete) one%iterations = iterations
   end subroutine read_record

   logical function take(stream, place, bytes)
      type(c_ptr), intent(in) :: stream, place
      integer, intent(in) :: bytes

      take = fread(place, 1_c_size_t, int(bytes, c_size_t), stream) == bytes
   end function take

   !> `program` in the folder of this one, if it is there; otherwise its name alone, for PATH.
   function beside(program) result(path)
      character(*), intent(in) :: program
      character(:), allocatable :: path
      integer :: length, slash
      logical :: is_there

      call get_command_argument(0, length=length)
      allocate (character(length) :: path)
      if (length > 0) call get_command_argument(0, path)
      slash = index(path, '/', back=.true.)
      path = path(:slash)//program
      inquire (file=path, exist=is_there)
      if (.not. is_there) path = program
   end function beside

   !> `text` as one word of a shell's command.
   pure function shell_word(text) result(word)
      character(*), intent(in) :: text
      character(:), allocatable :: word
      integer :: i

      word = ''''
      do i = 1, len(text)
         if (text(i:i) == '''') then
            word = word//'''\'''''
         else
            word = word//text(i:i)
         end if
      end do
      word = word//''''
   end function shell_word
end module kin
