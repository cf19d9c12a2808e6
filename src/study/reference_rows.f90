!> The rows of a deck in real128, as kinmat-quad writes them to its CSV: the truth of a study.
module reference_rows
   use, intrinsic :: iso_c_binding, only: c_ptr, c_char, c_associated, c_null_char
   use, intrinsic :: iso_fortran_env, only: qp => real128
   use numerals, only: whole
   implicit none
   private
   public :: reference_t, open_reference, read_reference, close_reference, no_number

   interface
      !> mkdtemp(3): makes a directory and completes its name; null on error.
      type(c_ptr) function mkdtemp(template) bind(c)
         import :: c_ptr, c_char
         character(kind=c_char), intent(inout) :: template(*)
      end function mkdtemp
   end interface

   type :: reference_t
      logical :: is_there = .false.            !< kinmat-quad was found
      integer :: unit = -1                     !< of the CSV
   end type reference_t

   !> Stands for a number that the reference does not have.
   real(qp), parameter :: no_number = huge(1.0_qp)
   !> A row has nine numbers of at most 44 characters, and less than a hundred others.
   integer, parameter :: row_length = 1024
   !> Seconds that the reference may take. What it has written until then is compared.
   integer, parameter :: patience = 60
   !> Cards that do not change a row of a link, point or pair, or that a study replaces.
   character(*), parameter :: left_out = 'METHOD|VARY|TOLER|EXTREMES|RANGE|CIRCUITS|ASSEMBLY|PROVE'

contains

   !> Lets kinmat-quad solve the deck in the file `path`. `r%is_there` is false if it stands neither beside this program
   !> nor in PATH, or if it computes in another kind of reals.
   subroutine open_reference(path, r)
      character(*), intent(in) :: path
      type(reference_t), intent(out) :: r
      character(:), allocatable :: folder, this
      integer :: status, length

      folder = made_folder()
      if (folder == '') return
      call get_command_argument(0, length=length)
      allocate (character(length) :: this)
      if (length > 0) call get_command_argument(0, this)
      this = this(:index(this, '/', back=.true.))//'kinmat-quad'
      call execute_command_line('exec 2>/dev/null; p='//shell_word(this)//'; [ -x "$p" ] || p=kinmat-quad; ' &
         //'case $("$p" --version) in *REAL128) ;; *) exit 1;; esac; ' &
         //'awk ''!/^[*]/ { kept = toupper($0) !~ /^('//left_out//')/ } kept'' '//shell_word(path) &
         //' | timeout '//whole(patience)//' "$p" --no-listing --csv '//shell_word(folder//'/rows'), exitstat=status)
      if (status /= 1) open (newunit=r%unit, file=folder//'/rows', action='read', iostat=status)
      r%is_there = status == 0
      ! The open file remains readable.
      call execute_command_line('rm -rf '//shell_word(folder))
   end subroutine open_reference

   !> Reads the next row of a link, point or pair if it is of set number `set` and instant number `step`, and has this
   !> `name`. `value` (3, 0:2): its numbers, angles as the deck has them; `no_number` for one that is missing, and for
   !> all if there is no such row.
   subroutine read_reference(r, set, step, name, value)
      type(reference_t), intent(in) :: r
      integer, intent(in) :: set, step
      character(*), intent(in) :: name
      real(qp), intent(out) :: value(3, 0:2)
      character(row_length) :: row
      character(len(name)) :: words(3)        ! the beginning of the time, the kind of row, and its name
      integer :: place(2), status, comma, i

      value = no_number
      do
         read (r%unit, '(a)', iostat=status) row
         if (status /= 0) return
         read (row, *, iostat=status) place, words
         if (status /= 0) cycle
         if (any(place /= [set, step])) then
            if (place(1) < set .or. (place(1) == set .and. place(2) < step)) cycle
            backspace (r%unit)
            return
         end if
         if (any(words(2) == ['LINK ', 'POINT', 'PAIR '])) exit
      end do
      if (words(3) /= name) return
      ! The nine numbers stand before the mark, which is the last cell. An empty cell leaves its number as it is.
      comma = len_trim(row) + 1
      do i = 1, 10
         comma = index(row(:comma - 1), ',', back=.true.)
      end do
      read (row(comma + 1:), *, iostat=status) value
      if (status /= 0) value = no_number
   end subroutine read_reference

   !> Closes the file of `r`.
   subroutine close_reference(r)
      type(reference_t), intent(inout) :: r

      if (r%is_there) close (r%unit)
      r%is_there = .false.
   end subroutine close_reference

   !> The name of a new folder for temporary files, '' if none can be made.
   function made_folder() result(name)
      character(:), allocatable :: name
      character(:), allocatable :: template
      integer :: length

      call get_environment_variable('TMPDIR', length=length)
      name = repeat(' ', length)
      if (length > 0) call get_environment_variable('TMPDIR', name)
      if (length == 0) name = '/tmp'
      template = name//'/kinmat-XXXXXX'//c_null_char
      name = ''
      if (c_associated(mkdtemp(template))) name = template(:len(template) - 1)
   end function made_folder

   !> `text` as one word of a shell's command.
   pure function shell_word(text) result(word)
      character(*), intent(in) :: text
      character(:), allocatable :: word
      integer :: i

      word = ''''
      do i = 1, len(text)
         word = word//text(i:i)
         if (text(i:i) == '''') word = word//'\'''''
      end do
      word = word//''''
   end function shell_word
end module reference_rows
