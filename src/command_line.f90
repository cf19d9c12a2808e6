!> The words of the command: the deck to read, the outputs to write, the sets to compute. For --explain, the entries of
!> the documents on messages, as lines for a terminal.
module command_line
   use number_format, only: whole
   use failures, only: failure_t, fail, status_rejected, capitals
   use cards, only: card_forms, form_name, find_form, form_unknown
   use document_texts, only: message_cell, message_count
   implicit none
   private
   public :: options_t, read_command, explained
   public :: out_listing, out_csv, out_log, out_summary, out_svg, out_animation, out_circuits, out_dxf, out_table, &
      out_shared, out_last

   !> The outputs that are files: up to `out_shared` those that all sets share, then, to `out_last`, those of each set.
   !> Those after `out_log` need a motion.
   enum, bind(c)
      enumerator :: out_listing = 1, out_csv, out_log, out_summary, out_svg, out_animation, out_circuits, out_dxf
      enumerator :: out_table
      enumerator :: out_shared = out_dxf, out_last = out_table
   end enum

   !> The options that name the files of the outputs. A further output costs a word here.
   character(*), parameter :: file_options(out_last) = [character(10) :: '-o', '--csv', '--log', '--summary', '--svg', &
      '--animate', '--circuits', '--dxf', '--table']

   !> A word of the command: the name of a file.
   type :: word_t
      character(:), allocatable :: text
   end type word_t

   !> The options of the command.
   type :: options_t
      !> '' is standard input; with --ruler the name of a card, or ''; with --explain its words.
      character(:), allocatable :: deck
      type(word_t) :: files(out_last)        !< '' is standard output; not allocated: this output is not asked for
      logical :: no_listing = .false.        !< no listing, not even on standard output
      logical :: quiet = .false.             !< no remarks on standard error
      logical :: check = .false.             !< read and analyse only
      logical :: errors = .false.            !< the CSV has an error estimate of every number
      logical :: arrows = .false.            !< pictures have arrows of velocities
      logical :: no_centrodes = .false.      !< pictures have no centrodes
      logical :: study = .false.             !< speed against error, instead of the listing
      logical :: time = .false.              !< the time of a step, instead of the listing
      integer :: share = 1, shares = 1       !< the share-th of so many shares of the deck's sets
      integer :: jobs = 0                    !< processes at a time; 0: one for each processor
      !> The text that is printed instead of computing: 'HELP', 'VERSION', 'RULER', 'EXPLAIN' or ''.
      character(:), allocatable :: show
   end type options_t

   !> The largest number of --jobs: more processes than any machine has processors would only take memory.
   integer, parameter :: max_jobs = 1024
   !> Digits of a whole number among the options: any such number is of the default kind.
   integer, parameter :: max_option_digits = 8

contains

   !> Reads the arguments of the process. Errors: status_rejected, for the first fault that is found.
   subroutine read_command(options, failure)
      type(options_t), intent(out) :: options   !< not complete after a failure
      type(failure_t), allocatable, intent(out) :: failure   !< not allocated: the arguments are right
      character(:), allocatable :: word
      integer :: i, k
      logical :: has_deck

      options%deck = ''
      options%show = ''
      has_deck = .false.

      i = 0
      do while (i < command_argument_count() .and. .not. allocated(failure))
         word = next_word()
         k = findloc(file_options == word, .true., dim=1)
         if (k > 0) then
            call read_file_name(options%files(k))
            cycle
         end if

         select case (word)
         case ('--sets')
            word = next_word()
            k = index(word, '/')
            options%share = whole_of(word(:max(0, k - 1)))
            options%shares = whole_of(word(k + 1:))
            if (options%share < 1 .or. options%share > options%shares) &
               call fail(failure, status_rejected, 'OPTION --sets NEEDS K/N WITH 1 <= K <= N, SUCH AS 1/4')
         case ('--jobs')
            options%jobs = whole_of(next_word())
            if (options%jobs < 1 .or. options%jobs > max_jobs) &
               call fail(failure, status_rejected, 'OPTION --jobs NEEDS A WHOLE NUMBER FROM 1 TO '//whole(max_jobs))

         case ('--errors')
            options%errors = .true.
         case ('--arrows')
            options%arrows = .true.
         case ('--no-centrodes')
            options%no_centrodes = .true.
         case ('--no-listing')
            options%no_listing = .true.
         case ('--quiet')
            options%quiet = .true.
         case ('--study')
            options%study = .true.
         case ('--time')
            options%time = .true.
         case ('--check')
            options%check = .true.

         case ('--help', '-h')
            options%show = 'HELP'
         case ('--version')
            options%show = 'VERSION'
         case ('--ruler')
            options%show = 'RULER'
         case ('--explain')
            ! All words that follow: the code of a message, or words of it.
            options%show = 'EXPLAIN'
            options%deck = ''
            do while (i < command_argument_count())
               options%deck = trim(options%deck//' '//next_word())
            end do
            options%deck = trim(adjustl(options%deck))
            if (len(explained(options%deck)) == 0) &
               call fail(failure, status_rejected, 'OPTION --explain NEEDS A CODE SUCH AS E101, OR WORDS OF A MESSAGE')

         case default
            if (len(word) == 0) then
               call fail(failure, status_rejected, 'THE NAME OF THE DECK IS EMPTY')
            else if (word(1:1) == '-' .and. word /= '-') then
               call fail(failure, status_rejected, 'OPTION '//word//' IS UNKNOWN; SEE kinmat --help')
            else if (has_deck) then
               call fail(failure, status_rejected, 'MORE THAN ONE DECK IS NAMED: '//options%deck//' AND '//word)
            else
               options%deck = word
               if (word == '-') options%deck = ''
               has_deck = .true.
            end if
         end select
      end do

      if (.not. allocated(failure)) call refuse_combinations(options, failure)
      if (.not. (options%no_listing .or. any(to_standard_output(options%files)) &
         .or. allocated(options%files(out_listing)%text))) options%files(out_listing)%text = ''

   contains

      !> Takes the name of a file from the word after `word`, its option: `-` is standard output.
      subroutine read_file_name(file)
         type(word_t), intent(inout) :: file   !< gets the name, '' for standard output
         character(:), allocatable :: path

         path = next_word()
         ! A file whose name begins with - is ./-NAME.
         if (len(path) == 0 .or. (index(path, '-') == 1 .and. path /= '-')) then
            call fail(failure, status_rejected, 'OPTION '//word//' NEEDS A FILE NAME')
         else if (allocated(file%text)) then
            call fail(failure, status_rejected, 'OPTION '//word//' IS GIVEN TWICE')
         end if
         if (path == '-') path = ''
         file%text = path
      end subroutine read_file_name

      !> Gives the word after word number `i`, '' if there is none, and increases `i` by 1.
      function next_word() result(next)
         character(:), allocatable :: next
         integer :: length

         i = i + 1
         call get_command_argument(i, length=length)
         allocate (character(length) :: next)
         if (length > 0) call get_command_argument(i, next)
      end function next_word
   end subroutine read_command

   !> Rejects options that exclude each other, or that lack what they need: the first fault that is found.
   subroutine refuse_combinations(options, failure)
      type(options_t), intent(in) :: options   !< as they are read
      type(failure_t), allocatable, intent(out) :: failure   !< not allocated: they fit one another
      character(:), allocatable :: names
      logical :: asked(out_last), is_study
      integer :: k

      asked = [(allocated(options%files(k)%text), k=1, out_last)]
      is_study = (options%study .or. options%time) .and. len(options%show) == 0

      ! A study and times are no listing; a study reads its deck more than once. Two outputs on standard output could
      ! not be told apart. Without motion there is nothing to draw.
      if (is_study .and. (any(asked(out_listing + 1:)) .or. options%errors .or. options%check .or. options%no_listing &
         .or. options%shares > 1 .or. options%jobs > 0 .or. (options%study .and. options%time))) then
         call fail(failure, status_rejected, 'OPTION '//trim(merge('--study', '--time ', options%study)) &
            //' CAN ONLY BE COMBINED WITH -o AND --quiet')
      else if (is_study .and. options%study .and. (len(options%deck) == 0 .or. options%deck == '/dev/stdin')) then
         call fail(failure, status_rejected, 'OPTION --study NEEDS THE DECK AS A FILE')
      else if (options%no_listing .and. asked(out_listing)) then
         call fail(failure, status_rejected, 'OPTIONS --no-listing AND -o EXCLUDE EACH OTHER')
      else if (count(to_standard_output(options%files)) > 1) then
         call fail(failure, status_rejected, 'ONLY ONE OUTPUT CAN GO TO STANDARD OUTPUT')
      else if (options%check .and. any(asked(out_log + 1:))) then
         call fail(failure, status_rejected, 'OPTION --check COMPUTES NO MOTION, WHICH ' &
            //trim(file_options(out_log + findloc(asked(out_log + 1:), .true., dim=1)))//' NEEDS')
      else if (options%show == 'RULER' .and. len(options%deck) > 0 .and. find_form(options%deck) == form_unknown) then
         names = ''
         do k = 1, size(card_forms)
            names = names//' '//trim(form_name(k))
         end do
         call fail(failure, status_rejected, &
            'OPTION --ruler: NO CARD HAS THE NAME '//options%deck//'; CARDS ARE'//names)
      end if
   end subroutine refuse_combinations

   !> Gives the value of a word; 0 if the word is no whole number, or has too many digits.
   pure integer function whole_of(word) result(number)
      character(*), intent(in) :: word       !< at most `max_option_digits` digits without a sign

      number = 0
      if (len(word) > 0 .and. len(word) <= max_option_digits .and. verify(word, '0123456789') == 0) &
         read (word, *) number
   end function whole_of

   !> Tells whether an output is asked for on standard output.
   elemental logical function to_standard_output(file)
      type(word_t), intent(in) :: file       !< the name of the output's file; not allocated: not asked for

      to_standard_output = .false.
      if (allocated(file%text)) to_standard_output = len(file%text) == 0
   end function to_standard_output

   !> Gives the entries of docs/messages.md that share most letters, in whole words, with the words of a question; ''
   !> if none shares a word. A blank line stands between two entries.
   pure function explained(words) result(text)
      character(*), intent(in) :: words      !< a code, words of a message, or a printed message
      character(:), allocatable :: text
      integer :: scores(message_count), i

      text = ''
      scores = [(likeness(message_cell(i, 1), trim(adjustl(capitals(words)))), i=1, message_count)]
      do i = 1, message_count
         if (scores(i) == 0 .or. scores(i) < maxval(scores)) cycle
         if (len(text) > 0) text = text//new_line('a')//new_line('a')
         text = text//message_cell(i, 2)
      end do
   end function explained

   !> Counts the letters of those words of a key that are words of a message, each word once.
   pure integer function likeness(message, key) result(letters)
      character(*), intent(in) :: message    !< words of the message, a blank between two
      character(*), intent(in) :: key        !< the words that are sought, a blank between two, in capitals
      integer :: first, last, next

      letters = 0
      first = 1
      do while (first <= len(key))
         next = first + index(key(first:)//' ', ' ')
         last = first - 1 + verify(key(first:next - 2), ',:;', back=.true.)
         if (index(' '//message//' ', ' '//key(first:last)//' ') > 0 .and. &
            index(' '//key(:first - 1), ' '//key(first:last)//' ') == 0) letters = letters + last - first + 1
         first = next
      end do
   end function likeness
end module command_line
